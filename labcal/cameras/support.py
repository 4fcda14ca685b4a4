"""The region of pictures and space in which dots supported a calibration, as it stands in ``rig.json``."""

from typing import Annotated

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict, Field

from labcal.bounds import LONGEST_SIDE_PX, Millimetres
from labcal.run.names import Name

_MOST = 2_000
"""Vertices of a hull."""
PixelPlace = Annotated[float, Field(ge=-2 * LONGEST_SIDE_PX, le=2 * LONGEST_SIDE_PX, allow_inf_nan=False)]


class CalibrationSupport(BaseModel):
    """Convex hulls of the dots that entered a calibration.

    Outside of them a calibration extrapolates: its lens models and its covariance are not checked there.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    pictures_px: dict[Name, Annotated[tuple[tuple[PixelPlace, PixelPlace], ...], Field(max_length=_MOST)]]
    """By camera, the vertices of the hull of its dots in order, px."""
    volume_mm: Annotated[tuple[tuple[Millimetres, Millimetres, Millimetres], ...], Field(max_length=_MOST)]
    """The vertices of the hull of all dots in the rig's world, mm; in no order."""

    def outline(self, camera: str) -> Float64[np.ndarray, "vertices 2"]:
        """Return the hull in a picture, px; without vertices where the camera is not known."""
        return np.array(self.pictures_px.get(camera, ()), dtype=np.float64).reshape(-1, 2)

    @property
    def volume(self) -> Float64[np.ndarray, "vertices 3"]:
        """The vertices of the hull in space, mm."""
        return np.array(self.volume_mm, dtype=np.float64).reshape(-1, 3)
