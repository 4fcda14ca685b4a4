"""A camera as it stands in ``rig.json`` and ``truth.json``."""

from collections.abc import Callable
from typing import Annotated

import numpy as np
from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    ValidationError,
    model_serializer,
    model_validator,
)

from labcal.arrays import Pose
from labcal.bounds import Side
from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENSES
from labcal.cameras.prescription import Prescription
from labcal.cameras.sense import require_middle_seen, require_placed, require_sensible_numbers
from labcal.cameras.window import Window
from labcal.errors import InputError
from labcal.run.descriptions import explain_validation

_COUNTS = (5, 8, 12, 14)
"""Of coefficients that OpenCV takes, five or more."""
Row3 = tuple[float, float, float]
Row4 = tuple[float, float, float, float]
Matrix3Record = tuple[Row3, Row3, Row3]
Matrix4Record = tuple[Row4, Row4, Row4, Row4]


def _placed(T_ab: Matrix4Record) -> Matrix4Record:
    """Return a transform that is rigid, and within the bounds of sense."""
    require_placed(np.array(T_ab), "a pose")
    return T_ab


PoseRecord = Annotated[Matrix4Record, AfterValidator(_placed)]
"""A rigid transform as it is read from a file, mm."""


def matrix4_record(T_ab: Pose) -> Matrix4Record:
    """Return a 4x4 transform as nested tuples."""
    rows = [(float(a), float(b), float(c), float(d)) for a, b, c, d in T_ab]
    return (rows[0], rows[1], rows[2], rows[3])


class CameraRecord(BaseModel):
    """One camera: pixels, OpenCV's coefficient order, millimetres."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    K: Matrix3Record
    """Camera matrix, px, without skew."""
    lens: str
    """Name of the lens model."""
    dist: Annotated[tuple[float, ...], Field(min_length=5, max_length=14)]
    """Coefficients in the order of the lens model, five or more."""
    T_cam_world: PoseRecord
    """Transform from the world to the camera, mm."""
    size: tuple[Side, Side]
    """Width and height of the picture, px."""
    prescription: Prescription | None = None
    """The lens's surfaces, where the lens is ``prescription``."""
    window: Window | None = None
    """Glass in front of the lens."""

    @model_validator(mode="after")
    def _is_sensible(self) -> "CameraRecord":
        require_sensible_numbers(self.K, self.lens, self.dist, self.size)
        own = LENSES[self.lens].coefficients if self.lens in LENSES else 0
        if len(self.dist) not in {*_COUNTS, own}:
            counts = ", ".join(map(str, sorted({*_COUNTS, own} - {0})))
            raise InputError(
                f"dist holds {len(self.dist)} coefficients, but should hold {counts}: one may be lost. Pad "
                "it with zeros if it ends early."
            )
        return self

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        return {key: value for key, value in dump(self).items() if value is not None}

    @classmethod
    def of(cls, camera: Camera) -> "CameraRecord":
        """Return the record of a camera.

        Raises
        ------
        InputError
            The camera is beyond the bounds of sense (:mod:`labcal.bounds`): it could not be read back.
        """
        K = [(float(a), float(b), float(c)) for a, b, c in camera.K]
        try:
            return cls(
                K=(K[0], K[1], K[2]),
                lens=camera.lens,
                dist=tuple(float(k) for k in camera.dist),
                T_cam_world=matrix4_record(camera.T_cam_world),
                size=camera.size,
                prescription=camera.prescription,
                window=camera.window,
            )
        except ValidationError as error:
            raise InputError(f"This is no possible camera: {explain_validation(error)}.") from error

    def camera(self) -> Camera:
        """Return the camera.

        Raises
        ------
        InputError
            The record is no possible camera.
        """
        return Camera(
            K=np.array(self.K),
            lens=self.lens,
            dist=np.array(self.dist),
            T_cam_world=np.array(self.T_cam_world),
            size=self.size,
            prescription=self.prescription,
            window=self.window,
        )

    def sensible_camera(self, name: str) -> Camera:
        """Return the camera of a record that was read, whose lens must image the middle of its picture.

        Parameters
        ----------
        name : str
            The camera's, for messages.

        Raises
        ------
        InputError
            The record is no possible camera.
        """
        camera = self.camera()
        require_middle_seen(camera, name)
        return camera
