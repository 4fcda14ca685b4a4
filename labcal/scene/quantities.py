"""Types of numbers in scenes; bounds of lengths are in :mod:`labcal.bounds`."""

from typing import Annotated

from pydantic import Field

from labcal.bounds import Margin

Share = Annotated[float, Field(ge=0, le=1)]
Colour = tuple[Share, Share, Share]
"""Reflectances of red, green and blue."""
Deviation = Margin
"""A standard deviation; 0 switches the defect off."""
