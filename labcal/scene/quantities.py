"""The kinds of numbers that a description of the laboratory is made of."""

from typing import Annotated

from pydantic import Field

Share = Annotated[float, Field(ge=0, le=1)]
Colour = tuple[Share, Share, Share]
"""Reflectances of red, green and blue."""
Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Deviation = Annotated[float, Field(ge=0, allow_inf_nan=False)]
"""A standard deviation; 0 switches the defect off."""
