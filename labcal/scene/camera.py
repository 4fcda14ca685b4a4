"""The description of a camera in a scene: lens, picture, position and direction."""

from typing import Annotated

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict, Field, field_validator, model_validator

from labcal.arrays import Matrix3
from labcal.bounds import Finite, Length, Millimetres, Quantity, Side
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENGTH, LENSES, undistorted_dist
from labcal.cameras.prescription import Prescription, load_prescription
from labcal.cameras.sense import require_sensible_numbers
from labcal.cameras.window import Window
from labcal.geometry.poses import look_at

Coordinate = Millimetres
Vector = tuple[Coordinate, Coordinate, Coordinate]


class Aperture(BaseModel):
    """An open lens: objects before or behind the focus distance are blurred."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    diameter_mm: Length
    """Diameter of the entrance pupil: focal length in mm over f-number."""
    focus_mm: Length
    """Distance along the camera's axis at which things are sharp (without a window)."""


class CameraDescription(BaseModel):
    """A camera and its place in the laboratory."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    size: tuple[Side, Side]
    """Width and height of the picture, px."""
    focal_px: Quantity
    """Focal length in pixels, the same along x and y."""
    principal_px: tuple[Coordinate, Coordinate] | None = None
    """Principal point; the middle of the picture where left out."""
    lens: str = "brown5"
    """Name of the lens model."""
    dist: Annotated[tuple[Finite, ...], Field(max_length=14)] = ()
    """Coefficients in the lens's order; those left out are those of no distortion, zero for most."""
    prescription: Prescription | None = None
    """For the lens ``prescription``: its surfaces; in a file the name of a lens, or its whole description."""
    window: Window | None = None
    """Glass in front of the lens."""
    aperture: Aperture | None = None
    """Open where things may be out of focus; where left out everything is sharp."""
    eye_mm: Vector
    """Centre of projection in the world."""
    look_at_mm: Vector
    """Point in the world that the camera's axis meets."""
    up: Vector = (0.0, 1.0, 0.0)
    """World direction towards the top of the picture."""

    @field_validator("prescription", mode="before")
    @classmethod
    def _prescription_by_name(cls, value: object) -> object:
        return load_prescription(value) if isinstance(value, str) else value

    @model_validator(mode="after")
    def _is_sensible(self) -> "CameraDescription":
        require_sensible_numbers(self._K().tolist(), self.lens, self._dist().tolist(), self.size)
        return self

    def _K(self) -> Matrix3:
        width, height = self.size
        cx, cy = self.principal_px or (0.5 * (width - 1), 0.5 * (height - 1))
        return np.array([[self.focal_px, 0.0, cx], [0.0, self.focal_px, cy], [0.0, 0.0, 1.0]])

    def _dist(self) -> Float64[np.ndarray, " coefficients"]:
        without = undistorted_dist(LENSES[self.lens]) if self.lens in LENSES else np.zeros(LENGTH)
        dist = np.zeros(max(len(without), len(self.dist)))
        dist[: len(without)] = without
        dist[: len(self.dist)] = self.dist
        return dist

    def camera(self) -> Camera:
        """Return the camera.

        Raises
        ------
        InputError
            It cannot look along its view, or its lens model does not have these coefficients.
        UnknownNameError
            There is no such lens model.
        """
        return Camera(
            K=self._K(),
            lens=self.lens,
            dist=self._dist(),
            T_cam_world=look_at(np.array(self.eye_mm), np.array(self.look_at_mm), np.array(self.up)),
            size=self.size,
            prescription=self._focused_prescription(),
            window=self.window,
        )

    def _focused_prescription(self) -> Prescription | None:
        """Return the prescription with the film at the focus distance of the aperture."""
        if self.prescription is None or self.aperture is None:
            return self.prescription
        return Prescription.model_validate(
            {**self.prescription.model_dump(), "focus_mm": self.aperture.focus_mm}
        )
