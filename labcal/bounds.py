"""Bounds of sense: what no camera, target or laboratory is beyond, so that a file that says so is damaged.

They are wide: what an instrument can be lies well within them. They stand here alone, so that a figure is
refused alike wherever it is read; docs/reference/bounds.md lists them for users.
"""

from collections.abc import Callable
from typing import Annotated

from pydantic import AfterValidator, Field

MOST_NUMBER = 2**63 - 1
"""Of a whole number in an argument or an option, a seed say: longer ones have no place in names of files."""
MOST_MM = 1e9
"""Of a coordinate or a length: a thousand kilometres."""
LEAST_MM = 1e-6
"""Of a length that is not nothing: a nanometre."""
LONGEST_SIDE_PX = 100_000
"""Of a picture."""
MOST_PIXELS = 400_000_000
"""Of a picture; what is decoded or resampled has a bound of its own."""
FOCAL_SIDES = (0.01, 1000.0)
"""The focal length over the picture's longer side: fields of less than a degree to all around."""
FIELD_MM = (1e-3, 1e6)
"""Length of the object plane along the picture's longer side through a lens with parallel rays."""
FOCAL_RATIO = 10.0
"""Between the two focal lengths of a camera."""
PRINCIPAL_SIDES = 20.0
"""Distance of the principal point from the middle of the picture, in longer sides; large in cut-outs."""
MOST_DISTORTION = 1e4
"""Of what a single coefficient does at the picture's rim (or at 45 degrees), over the radius there."""
MOST_TILT_RAD = 1.4
"""Of a tilted sensor: beyond 80 degrees it sees nothing."""
MOST_PICTURES = 200_000
"""Of a shoot or a table."""
MARGIN_SIDES = 1.0
"""Distance of a measured dot from its picture, in sides of the picture."""
LEAST_VARIANCE_PX2 = 1e-18
"""Of a measured position: a billionth of a pixel, squared. Below it, covariances cannot be inverted."""
MOST_INDEX = 10_000
"""Of a dot's column or row, also beyond the declared grid."""
MOST_DOTS = 250_000
"""On one target."""
LEAST_SHARE_OF_PITCH = 1e-3
"""Of a dot's diameter."""
MOST_PARAMETER_VARIANCE = 1e24
"""Of a parameter of a camera, in its unit squared; what views leave open has some very large one."""
MOST_WEIGHT = 1e60
"""Of a number in a model: squares and products of a few of them are still numbers."""


def _more_than_nothing(least: float) -> Callable[[float], float]:
    """Return a check that a positive number is not next to nothing."""

    def checked(value: float) -> float:
        if value < least:
            raise ValueError(f"{value!r} is next to nothing: it should be at least {least!r}")
        return value

    return checked


Millimetres = Annotated[float, Field(ge=-MOST_MM, le=MOST_MM, allow_inf_nan=False)]
"""A coordinate, mm."""
Length = Annotated[
    float, Field(gt=0, le=MOST_MM, allow_inf_nan=False), AfterValidator(_more_than_nothing(LEAST_MM))
]
"""A length that is not nothing, mm."""
Margin = Annotated[float, Field(ge=0, le=MOST_MM, allow_inf_nan=False)]
"""A length that may be nothing, mm."""
Quantity = Annotated[
    float, Field(gt=0, le=1e12, allow_inf_nan=False), AfterValidator(_more_than_nothing(1e-12))
]
"""A positive amount of something that is no length: light, electrons, time."""
Amount = Annotated[float, Field(ge=0, le=1e12, allow_inf_nan=False)]
"""The same where it may be nothing."""
Finite = Annotated[float, Field(ge=-1e12, le=1e12, allow_inf_nan=False)]
"""A plain number that a person writes down."""
Side = Annotated[int, Field(ge=1, le=LONGEST_SIDE_PX)]
"""Width or height of a picture, px."""
