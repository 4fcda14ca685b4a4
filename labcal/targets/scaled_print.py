"""The scale of a print: what a printer made of the designed lengths."""

from collections.abc import Callable
from typing import Annotated, Any

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, Field, model_serializer

LEAST_SCALE, MOST_SCALE = 0.5, 2.0
"""Of a print over its design; "fit to page" changes it by less."""

_Scale = Annotated[float, Field(ge=LEAST_SCALE, le=MOST_SCALE, allow_inf_nan=False)]


class ScaledPrint(BaseModel):
    """The part of a target's description that is of one print of it; all other lengths are as designed."""

    print_scale: tuple[_Scale, _Scale] | None = None
    """Measured over nominal length of the print along x and y; left out where it was not measured."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, dump: Callable[[Any], dict[str, Any]]) -> dict[str, Any]:
        return {key: value for key, value in dump(self).items() if key != "print_scale" or value is not None}

    @property
    def scale_x_y(self) -> Float64[np.ndarray, "2"]:
        """The scale along x and y, 1 where it was not measured."""
        return np.array(self.print_scale or (1.0, 1.0), dtype=np.float64)

    @property
    def mean_scale(self) -> float:
        """The root of the scale of areas: that of diameters."""
        return float(np.sqrt(self.scale_x_y.prod()))
