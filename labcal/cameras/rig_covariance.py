"""The joint covariance of a rig's parameters, as it stands in ``rig.json``."""

from collections.abc import Mapping
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bounds import Amount, Margin
from labcal.cameras.lower_triangle import (
    MOST_PARAMETERS,
    Element,
    full_matrix,
    lower_triangle,
    require_covariance,
)
from labcal.cameras.record import CameraRecord
from labcal.wording import clipped, printable

POSE_PARAMETERS = ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z")
"""Rotation vector about the camera's axes (rad), applied after ``T_cam_world``, and shift along them (mm)."""
INTRINSIC_PARAMETERS = ("fx", "fy", "cx", "cy")
"""Px."""


class RigCovariance(BaseModel):
    """Joint covariance of lenses and poses, board poses marginalised out.

    Datum: the world is the first camera's frame, whose pose is exact. The scale is that of the target's
    pitch; its uncertainty enters by single dots that are off (``print_sigma_mm``), not by a print that is too
    large as a whole, of which no view tells.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    datum: Literal["first-camera, target-pitch"] = "first-camera, target-pitch"
    """Frame and scale, which are exact by definition."""
    parameters: Annotated[tuple[str, ...], Field(min_length=1, max_length=MOST_PARAMETERS)]
    """Names in order: camera by camera ``CAMERA.fx`` and so on, coefficients, then turns and shifts."""
    lower: tuple[tuple[Element, ...], ...]
    """Lower triangle of the covariance, a tuple for each row; px, rad, mm and the coefficients' units."""
    noise_factor: Amount = 1.0
    """Variance of residuals without the print's share, over the one that dots' covariances and the variance
    component state; a factor of the matrix."""
    view_factor: Annotated[float, Field(ge=1, le=1e12, allow_inf_nan=False)] = 1.0
    """Factor by which views disagree beyond the noise of their dots; a factor of the matrix, unless it is
    beyond chance: then errors that dots of a view share have variances of their own in the matrix."""
    print_sigma_mm: Margin = 0.0
    """Standard deviation of the dots' places on the print along each direction; its share is included."""

    @model_validator(mode="after")
    def _is_a_covariance(self) -> "RigCovariance":
        require_covariance(self.lower, len(self.parameters))
        return self

    @property
    def matrix(self) -> Float64[np.ndarray, "parameters parameters"]:
        """The covariance as a full matrix."""
        return full_matrix(self.lower)

    @classmethod
    def of(
        cls, cameras: Mapping[str, CameraRecord], covariance: Float64[np.ndarray, "parameters parameters"]
    ) -> "RigCovariance":
        """Return the record of a covariance in the order of :func:`parameter_names`, without its sources."""
        return cls(parameters=parameter_names(cameras), lower=lower_triangle(covariance))


def parameter_names(cameras: Mapping[str, CameraRecord]) -> tuple[str, ...]:
    """Return the names of the free parameters of a rig: lens by lens, the pose of all but the first.

    Examples
    --------
    >>> from labcal import examples
    >>> names = parameter_names(examples.rig().cameras)
    >>> len(names), names[:5], names[-1]
    (24, ('left.fx', 'left.fy', 'left.cx', 'left.cy', 'left.k1'), 'right.shift_z')
    """
    names: list[str] = []
    for number, (name, record) in enumerate(cameras.items()):
        own = (*INTRINSIC_PARAMETERS, *record.camera().model.names, *(POSE_PARAMETERS if number else ()))
        names += [f"{name}.{parameter}" for parameter in own]
    return tuple(names)


def wrong_parameters(cameras: Mapping[str, CameraRecord], covariance: RigCovariance) -> str | None:
    """Return why a covariance is not of these cameras, at the end of a sentence; None where it is."""
    expected = parameter_names(cameras)
    if covariance.parameters == expected:
        return None
    if len(covariance.parameters) != len(expected):
        return f"its covariance has {len(covariance.parameters)} parameters, but its cameras {len(expected)}"
    pairs = zip(covariance.parameters, expected, strict=True)
    given, wanted = next((given, wanted) for given, wanted in pairs if given != wanted)
    return f"its covariance has the parameter '{clipped(printable(given))}' where '{wanted}' is expected"
