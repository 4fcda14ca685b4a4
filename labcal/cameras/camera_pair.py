"""Baseline of two cameras and the angle between them, with their standard deviations."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.cameras.camera import Camera
from labcal.cameras.rig_covariance import POSE_PARAMETERS, RigCovariance
from labcal.geometry.cross_matrices import cross_matrices

_PARALLEL = 1e-9
"""Sine of the angle below which no direction of its change is told from another."""


@dataclass(frozen=True)
class CameraPair:
    """How two cameras stand to each other.

    Attributes
    ----------
    first, second : str
        Names of the cameras.
    baseline_mm, baseline_sigma_mm : float
        Distance of their centres of projection; NaN where the rays of one are parallel and meet in no centre.
    angle_deg, angle_sigma_deg : float
        Angle between their optical axes.

    Notes
    -----
    Standard deviations are propagated from the joint covariance of the rig, and NaN where it states none. The
    scale of the target counts as exact: a pitch that is 0.1% too large makes the baseline 0.1% too large.
    """

    first: str
    second: str
    baseline_mm: float
    baseline_sigma_mm: float
    angle_deg: float
    angle_sigma_deg: float


def camera_pair(
    cameras: Mapping[str, Camera], names: tuple[str, str], covariance: RigCovariance | None
) -> CameraPair:
    """Return how two cameras of a rig stand to each other.

    Parameters
    ----------
    cameras : mapping of str to Camera
        All of the rig.
    names : (str, str)
        Of the two.
    covariance : RigCovariance or None
        Of the rig.
    """
    one, other = (cameras[name] for name in names)
    between = other.centre - one.centre
    baseline = float(np.linalg.norm(between))
    axes = [camera.T_cam_world[2, :3] for camera in (one, other)]
    normal = np.cross(axes[0], axes[1])
    sine = float(np.linalg.norm(normal))
    angle = float(np.degrees(np.arctan2(sine, axes[0] @ axes[1])))
    baseline_sigma = angle_sigma = float("nan")
    if covariance is not None:
        turns, shifts = _motions(cameras, names, covariance)
        toward = between / baseline if baseline > 0.0 else np.zeros(3)
        baseline_sigma = _sigma(toward[None] @ shifts, covariance)
        about = normal[None] / sine if sine > _PARALLEL else np.eye(3) - np.outer(axes[0], axes[0])
        angle_sigma = float(np.degrees(_sigma(about @ turns, covariance)))
    if one.model.parallel or other.model.parallel:
        baseline = baseline_sigma = float("nan")
    return CameraPair(*names, baseline, baseline_sigma, angle, angle_sigma)


def _motions(
    cameras: Mapping[str, Camera], names: tuple[str, str], covariance: RigCovariance
) -> tuple[Float64[np.ndarray, "3 parameters"], Float64[np.ndarray, "3 parameters"]]:
    """Return the derivatives of the second camera's rotation and centre less the first one's, in the world.

    A turn w about the camera's centre of coordinates and a shift s, both along its axes, make the pose
    (exp(w) R, t + s): the axis turns by -R'w, the centre -R't moves by R'(w x t) - R's.
    """
    turns, shifts = np.zeros((2, 3, len(covariance.parameters)))
    number = {name: place for place, name in enumerate(covariance.parameters)}
    for name, sign in zip(names, (-1.0, 1.0), strict=True):
        places = [number[key] for key in (f"{name}.{one}" for one in POSE_PARAMETERS) if key in number]
        if not places:  # the world's camera, which is exact
            continue
        back, t = cameras[name].T_cam_world[:3, :3].T, cameras[name].T_cam_world[:3, 3]
        turns[:, places[:3]] = -sign * back
        shifts[:, places[:3]] = -sign * back @ cross_matrices(t[None])[0]
        shifts[:, places[3:]] = -sign * back
    return turns, shifts


def _sigma(by: Float64[np.ndarray, "k parameters"], covariance: RigCovariance) -> float:
    """Return the largest standard deviation of some directions."""
    spread = by @ covariance.matrix @ by.T
    return float(np.sqrt(max(0.0, np.linalg.eigvalsh(spread)[-1])))
