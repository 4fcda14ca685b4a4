"""The joint covariance of a rig's parameters, as it stands in ``rig.json``."""

from collections.abc import Mapping
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict, Field, model_validator

from labcal.bounds import MOST_PARAMETER_VARIANCE, Amount, Margin
from labcal.cameras.record import CameraRecord
from labcal.wording import clipped, printable

POSE_PARAMETERS = ("turn_x", "turn_y", "turn_z", "shift_x", "shift_y", "shift_z")
"""Rotation vector about the camera's axes (rad), applied after ``T_cam_world``, and shift along them (mm)."""
INTRINSIC_PARAMETERS = ("fx", "fy", "cx", "cy")
"""Px."""
_MOST = 400
"""Parameters of a rig, at most: twenty cameras."""
_ROUNDING = 1e-6
"""Of the least eigenvalue of correlations, below which they are none."""
Element = Annotated[
    float, Field(ge=-MOST_PARAMETER_VARIANCE, le=MOST_PARAMETER_VARIANCE, allow_inf_nan=False)
]
"""Of a covariance."""


class RigCovariance(BaseModel):
    """Joint covariance of lenses and poses, board poses marginalised out.

    Datum: the world is the first camera's frame, whose pose is exact. The scale is that of the target's
    pitch; its uncertainty enters by single dots that are off (``print_sigma_mm``), not by a print that is too
    large as a whole, of which no view tells.
    """

    model_config = ConfigDict(frozen=True, extra="forbid")

    datum: Literal["first-camera, target-pitch"] = "first-camera, target-pitch"
    """Frame and scale, which are exact by definition."""
    parameters: Annotated[tuple[str, ...], Field(min_length=1, max_length=_MOST)]
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
        count = len(self.parameters)
        if [len(row) for row in self.lower] != list(range(1, count + 1)):
            raise ValueError(f"'lower' has not the rows of a lower triangle of {count} parameters")
        variance = np.array([row[-1] for row in self.lower])
        if not (variance >= 0.0).all():
            raise ValueError("'lower' has a negative variance")
        scale = np.sqrt(np.where(variance > 0.0, variance, 1.0))
        correlation = self.matrix / scale[:, None] / scale
        if not np.isfinite(correlation).all() or not np.linalg.eigvalsh(correlation)[0] > -_ROUNDING * count:
            raise ValueError("'lower' is no covariance: some combination has a negative variance")
        return self

    @property
    def matrix(self) -> Float64[np.ndarray, "parameters parameters"]:
        """The covariance as a full matrix."""
        count = len(self.parameters)
        matrix = np.zeros((count, count))
        matrix[np.tril_indices(count)] = [value for row in self.lower for value in row]
        return matrix + np.tril(matrix, -1).T

    @classmethod
    def of(
        cls, cameras: Mapping[str, CameraRecord], covariance: Float64[np.ndarray, "parameters parameters"]
    ) -> "RigCovariance":
        """Return the record of a covariance in the order of :func:`parameter_names`, without its sources."""
        lower = tuple(tuple(row[: number + 1].tolist()) for number, row in enumerate(covariance))
        return cls(parameters=parameter_names(cameras), lower=lower)


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
