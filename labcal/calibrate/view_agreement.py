"""Inconsistent views and impossible pictures, which are reported by name and left out."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pose
from labcal.calibrate.agreement.exchange.decision import LEFT_OF_POSES, explains
from labcal.calibrate.rig_start import SharedViews, SingleCamera, placed_cameras
from labcal.errors import InputError
from labcal.geometry.poses import inverse, transform

_FEWEST = 3
"""Shared views from which on one that is off can be expected from the others."""
_TIMES = 10.0
"""Ratio of the residual of an inconsistent view to that of the median view."""
_LEAST_PX = 2.0


@dataclass(frozen=True)
class InconsistentPicture:
    """A picture that is left out."""

    camera: str
    view: int
    """Number of the view in the rig's adjustment."""
    reason: str
    """For people."""


def seen_from_behind(single: SingleCamera) -> list[InconsistentPicture]:
    """Return the pictures of one camera that show the target's back, which has no dots.

    Raises
    ------
    InputError
        All of them do.
    """
    normal, middle = single.T_cam_target[:, :3, 2], single.T_cam_target[:, :3, 3]
    behind = (normal * middle).sum(axis=1) > 0.0
    if behind.all():
        raise InputError(
            f"All pictures of camera '{single.name}' show the target mirrored. Take pictures as the sensor "
            "has them, not as a mirror shows them, and number columns to the right and rows upwards."
        )
    reason = "it shows the target mirrored, or its dots are numbered in a mirror image"
    return [InconsistentPicture(single.name, int(view), reason) for view in single.views[behind]]


def contradictions(
    cameras: Sequence[SingleCamera], dots: Float64[np.ndarray, "dots 3"]
) -> list[InconsistentPicture]:
    """Return the pictures of views in which cameras do not agree on where the target is.

    Of three cameras or more those that agree with each other stay.

    Parameters
    ----------
    cameras : sequence of SingleCamera
    dots : ndarray, shape (dots, 3)
        Places in the target's frame, mm.

    Raises
    ------
    InputError
        A camera shares no view with the first one, not even through others.
    """
    placed = placed_cameras(cameras)
    against: dict[int, list[tuple[int, int]]] = {}
    reasons: dict[int, str] = {}
    for one, other in combinations(range(len(cameras)), 2):
        shared = SharedViews.of(cameras[one], cameras[other])
        T_other_one = placed[other] @ inverse(placed[one])
        residuals = target_residuals(cameras[other], T_other_one, shared, dots)
        if len(residuals) < _FEWEST:
            continue
        usual = float(np.median(residuals))
        for at in np.flatnonzero(residuals > max(_TIMES * usual, _LEAST_PX)):
            view = int(shared.views[at])
            against.setdefault(view, []).append((one, other))
            alone = SharedViews(shared.views[[at]], shared.first[[at]], shared.second[[at]])
            exchanged = target_residuals(cameras[other], inverse(T_other_one), alone, dots)[0]
            if explains(float(residuals[at]), float(exchanged), _LEAST_PX, LEFT_OF_POSES):
                cause = "their pictures seem to be exchanged"
            else:
                cause = (
                    "the target moved between the exposures, a camera was moved, or one of them has dots "
                    "numbered wrongly"
                )
            reasons[view] = (
                f"cameras '{cameras[one].name}' and '{cameras[other].name}' disagree on the dots by "
                f"{residuals[at]:.1f} px, in the median view by {usual:.1f} px: {cause}"
            )
    return [
        InconsistentPicture(cameras[number].name, view, reasons[view])
        for view, pairs in sorted(against.items())
        for number in majority_outliers(
            pairs, [n for n, single in enumerate(cameras) if view in single.views]
        )
    ]


def target_residuals(
    camera: SingleCamera, T_camera_other: Pose, shared: SharedViews, dots: Float64[np.ndarray, "dots 3"]
) -> Float64[np.ndarray, " n"]:
    """Return the residuals of the target of another camera in the pictures of this camera, RMS, px."""
    residuals = []
    for T_other_target, T_camera_target in zip(shared.first, shared.second, strict=True):
        expected = camera.camera.project_in_camera(transform(T_camera_other @ T_other_target, dots)).q
        seen = camera.camera.project_in_camera(transform(T_camera_target, dots)).q
        square = ((expected - seen) ** 2).sum(axis=1)
        known = square[np.isfinite(square)]
        residuals.append(float(np.sqrt(known.mean())) if len(known) else float("inf"))
    return np.array(residuals)


def majority_outliers(against: list[tuple[int, int]], cameras: list[int]) -> list[int]:
    """Return the cameras of a view that are not in its largest group of two or more that agree."""
    groups: list[list[int]] = []
    for camera in cameras:
        for group in groups:
            if all((other, camera) not in against for other in group):
                group.append(camera)
                break
        else:
            groups.append([camera])
    largest = max(groups, key=len)
    tied = sum(len(group) == len(largest) for group in groups) > 1
    return [camera for camera in cameras if tied or camera not in largest]
