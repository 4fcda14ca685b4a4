"""A camera as a scene describes it: a lens, a picture, and where it stands and looks."""

from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field

from labcal.cameras.brown import LENGTH
from labcal.cameras.camera import Camera
from labcal.geometry.poses import look_at

Coordinate = Annotated[float, Field(allow_inf_nan=False)]
Vector = tuple[Coordinate, Coordinate, Coordinate]
Count = Annotated[int, Field(ge=1)]


class CameraDescription(BaseModel):
    """A camera and its place in the laboratory."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: tuple[Count, Count]
    """Width and height of the picture, px."""
    focal_px: Annotated[float, Field(gt=0, allow_inf_nan=False)]
    """Focal length in pixels, the same along x and y."""
    principal_px: tuple[Coordinate, Coordinate] | None = None
    """Principal point; the middle of the picture where left out."""
    lens: str = "brown5"
    dist: tuple[Coordinate, ...] = ()
    """Coefficients in OpenCV's order; those left out are zero."""
    eye_mm: Vector
    look_at_mm: Vector
    up: Vector = (0.0, 1.0, 0.0)
    """World direction towards the top of the picture."""

    def camera(self) -> Camera:
        """Return the camera.

        Raises
        ------
        InputError
            It cannot look along its view, or its lens model does not have these coefficients.
        UnknownNameError
            There is no such lens model.
        """
        width, height = self.size
        cx, cy = self.principal_px or (0.5 * (width - 1), 0.5 * (height - 1))
        dist = np.zeros(max(LENGTH, len(self.dist)))
        dist[: len(self.dist)] = self.dist
        return Camera(
            K=np.array([[self.focal_px, 0.0, cx], [0.0, self.focal_px, cy], [0.0, 0.0, 1.0]]),
            lens=self.lens,
            dist=dist,
            T_cam_world=look_at(np.array(self.eye_mm), np.array(self.look_at_mm), np.array(self.up)),
            size=self.size,
        )
