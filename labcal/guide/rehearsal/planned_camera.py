"""A camera of a plan: lens, sensor and picture, as data sheets state them."""

from math import cos, radians, sin
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from labcal.bounds import Finite, Length, Quantity, Side
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENSES, undistorted_dist
from labcal.errors import UnknownNameError
from labcal.scene.camera import CameraDescription, Coordinate, Vector

_WAYS = ("focal_px", "focal_mm", "fov_deg")
_TRIAL_PX = 1000.0


class PlannedCamera(BaseModel):
    """A camera, without its place.

    The focal length is given in one of three ways: in px; in mm with the pixel pitch; or by the field of view
    along the picture's width, of the lens without distortion.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: tuple[Side, Side]
    """Width and height of the picture, px."""
    focal_px: Quantity | None = None
    focal_mm: Length | None = None
    """Together with `pixel_um`."""
    fov_deg: Annotated[float, Field(gt=0, lt=360)] | None = None
    pixel_um: Quantity | None = None
    """Pitch of the sensor's pixels, micrometres."""
    principal_px: tuple[Coordinate, Coordinate] | None = None
    """Principal point; the middle of the picture where left out."""
    lens: str = "brown5"
    """Name of the lens model."""
    dist: Annotated[tuple[Finite, ...], Field(max_length=14)] = ()
    """Coefficients in the lens's order; those left out are those of no distortion."""

    @field_validator("lens")
    @classmethod
    def _is_adjustable(cls, value: str) -> str:
        if value not in LENSES:
            raise ValueError(str(UnknownNameError("lens model", value, LENSES)))
        if LENSES[value].parallel:
            raise ValueError(
                f"cameras with parallel rays, such as '{value}', cannot be rehearsed: choose a lens with a "
                "centre of projection"
            )
        return value

    @model_validator(mode="after")
    def _has_one_focal_length(self) -> "PlannedCamera":
        given = [way for way in _WAYS if getattr(self, way) is not None]
        if len(given) != 1:
            named = " and ".join(given) or "none of them"
            raise ValueError(
                f"the focal length should be given by one of focal_px, focal_mm and fov_deg, but {named} is"
                if len(given) < 2  # noqa: PLR2004 -- more than one
                else f"the focal length should be given once, but {named} are: keep one of them"
            )
        if (self.focal_mm is None) != (self.pixel_um is None):
            raise ValueError(
                "focal_mm and pixel_um belong together: give both, or the focal length as focal_px or fov_deg"
            )
        self.focal_length_px()
        return self

    def focal_length_px(self) -> float:
        """Return the focal length in px."""
        if self.focal_px is not None:
            return self.focal_px
        if self.focal_mm is not None and self.pixel_um is not None:
            return 1000.0 * self.focal_mm / self.pixel_um
        return self._focal_of_field(radians(0.5 * float(self.fov_deg or 0.0)))

    def described(self, eye: Vector, look_at: Vector, up: Vector) -> CameraDescription:
        """Return the camera at its place, for a scene."""
        return CameraDescription(
            size=self.size,
            focal_px=self.focal_length_px(),
            principal_px=self.principal_px,
            lens=self.lens,
            dist=self.dist,
            eye_mm=eye,
            look_at_mm=look_at,
            up=up,
        )

    def _focal_of_field(self, half_field: float) -> float:
        """Return the focal length at which half the picture's width shows half the field."""
        K = np.diag([_TRIAL_PX, _TRIAL_PX, 1.0])
        plain = Camera(K, self.lens, undistorted_dist(LENSES[self.lens]), np.eye(4), self.size)
        image = plain.project([sin(half_field), 0.0, cos(half_field)])
        if not image.ok:
            raise ValueError(
                f"the lens '{self.lens}' shows no field of {self.fov_deg:g} degrees: give fewer, or another "
                "lens, such as fisheye-kb4"
            )
        return 0.5 * self.size[0] * _TRIAL_PX / float(image.q[0])
