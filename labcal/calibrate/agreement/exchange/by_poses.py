"""Exchanged pictures of a hand-held target, found by its poses in two cameras."""

from dataclasses import replace

import numpy as np
from jaxtyping import Bool

from labcal.arrays import Vectors3
from labcal.calibrate.agreement.exchange.decision import LEFT_OF_POSES, explains
from labcal.calibrate.rig_start import SharedViews
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.calibrate.view_agreement import target_residuals
from labcal.correspond.detections import Detections
from labcal.geometry.poses import inverse

_CANDIDATES = 20
"""Views that are tried for a reference."""


def exchanged_views(
    first: SingleCalibration, second: SingleCalibration, dots: Vectors3
) -> Bool[np.ndarray, " n"] | None:
    """Return the shared views whose pictures seem to be exchanged.

    The poses between the cameras of exchanged views are the inverse of the others'. None where the poses of
    all views are not much more alike when some are taken for inverse ones, or where pictures of two sizes
    cannot have been exchanged. Of two parts the smaller one counts as exchanged; of equal ones the later.

    Parameters
    ----------
    first, second : SingleCalibration
    dots : ndarray, shape (dots, 3)
        Places in the target's frame, mm.
    """
    shared = SharedViews.of(first.single, second.single)
    if first.single.camera.size != second.single.camera.size:
        return None
    bound = (
        LEFT_OF_POSES * first.single.camera.size[0]
    )  # dots that are not imaged are off by a picture's width
    best: tuple[float, Bool[np.ndarray, " n"]] | None = None
    for at in range(0, len(shared.views), -(-len(shared.views) // _CANDIDATES)):
        T_second_first = shared.second[at] @ inverse(shared.first[at])
        given = target_residuals(second.single, T_second_first, shared, dots)
        other = target_residuals(second.single, inverse(T_second_first), shared, dots)
        left = float(np.minimum(given, other).mean())
        if explains(float(given.mean()), left, bound, LEFT_OF_POSES) and (best is None or left < best[0]):
            best = (left, other < given)
    if best is None:
        return None
    exchanged = best[1]
    if exchanged.mean() > 0.5 or (exchanged.mean() == 0.5 and exchanged[0]):  # noqa: PLR2004 -- half
        exchanged = ~exchanged
    return exchanged


def with_exchanged(entering: Detections, cameras: tuple[str, str], views: tuple[str, ...]) -> Detections:
    """Return detections with the pictures of two cameras exchanged in some views."""
    first, second = cameras
    in_views = np.isin(entering.view, views)
    other = np.where(
        entering.camera == first, second, np.where(entering.camera == second, first, entering.camera)
    )
    return replace(entering, camera=np.where(in_views, other, entering.camera))
