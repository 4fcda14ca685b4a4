"""The 3-D error of a rig that is calibrated with mistakes left in, beside the one without them."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.errors import InputError
from labcal.geometry.poses import rigid_alignment, transform
from labcal.guide.diagnosis.forms.explaining import BY_VIEW, CHANGES, SHAPES, Explained
from labcal.guide.diagnosis.forms.hypotheses import Hypothesis
from labcal.guide.diagnosis.forms.shoot_model import ShootModel


def with_rig_errors(found: Explained, model: ShootModel, calibration: HandheldCalibration) -> Explained:
    """Return explanations with what they cost in a rig that was calibrated with the mistakes left in.

    The linear model tells their shares; of large mistakes it overestimates the sum. Errors that each view has
    for itself leave no mended rig that is sure enough to compare with: among such, costs stay as they are. A
    calibration that has freed the dots takes up the board's shape, which then has no share beside others.

    Parameters
    ----------
    found : Explained
    model : ShootModel
    calibration : HandheldCalibration
        Mistakes left in.
    """
    rig = calibration.rig
    if calibration.dot_decision.frees:
        found = _without_shapes(found)
    costs = [one.bias_mm for one in found.found if one.bias_mm]
    if not costs or any(one.hypothesis.check in BY_VIEW for one in found.found):
        return found
    whole = rig_error_mm(model, [one.hypothesis for one in found.found], rig)
    if not whole:
        return found
    factor = whole / float(np.linalg.norm(costs))
    return replace(
        found,
        found=tuple(
            one if one.bias_mm is None else replace(one, bias_mm=factor * one.bias_mm) for one in found.found
        ),
    )


def _without_shapes(found: Explained) -> Explained:
    """Return explanations of which shapes of the board cost nothing, if there are others."""
    of_shape = [one.hypothesis.check in SHAPES for one in found.found]
    if all(of_shape):
        return found
    return replace(
        found,
        found=tuple(
            replace(one, bias_mm=0.0) if shape and one.bias_mm is not None else one
            for one, shape in zip(found.found, of_shape, strict=True)
        ),
    )


def rig_error_mm(model: ShootModel, chosen: Sequence[Hypothesis], rig: Rig) -> float | None:
    """Return the RMS 3-D error of a rig over the volume and over the views of a shoot, less that by chance.

    The cameras as the mistakes leave them at each view image the points, and the rig reconstructs them. The
    points are brought onto the true ones by a rigid motion: the world of a target in the hand is nobody's.

    Parameters
    ----------
    model : ShootModel
    chosen : sequence of Hypothesis
        All mistakes of the shoot.
    rig : Rig
        As calibrated from it, mistakes left in.

    Returns
    -------
    float or None
        Mm; None where there is no volume, or the rig reconstructs less than half of it.
    """
    volume, square = model.volume, model.square
    if volume is None or square is None or tuple(rig.cameras) != model.names:
        return None
    fit = model.fit([term for one in chosen for term in one.terms])
    count = len(square)
    measuring, total = [rig.camera(name) for name in rig.cameras], 0.0
    moments, times = np.unique(_moments(model, chosen, fit.values), axis=0, return_counts=True)
    for values, often in zip(moments, times.tolist(), strict=True):
        cameras = _cameras(model, values)
        if cameras is None:
            return None
        q = np.stack([camera.project(volume.points).q for camera in cameras], axis=1)
        found = triangulate(measuring, np.nan_to_num(q, nan=-1e6), volume.pixels).point
        good = np.isfinite(found).all(axis=1) & np.isfinite(q).all(axis=(1, 2))
        if good.sum() < max(4.0, 0.5 * len(good)):
            return None
        p = volume.points[good]
        off = transform(rigid_alignment(p, found[good]), found[good]) - p
        total += often * float((off**2).sum(axis=1).mean())
    own, good_one = fit.covariance[:count, :count], model.good.covariance[:count, :count]
    by_chance = model.own_noise([term for one in chosen for term in one.terms]) * float(
        np.sum(square * (own - good_one))
    )
    return float(np.sqrt(max(0.0, total / times.sum() - max(0.0, by_chance))))


def _moments(
    model: ShootModel, chosen: Sequence[Hypothesis], values: Float64[np.ndarray, " parameters"]
) -> Float64[np.ndarray, "views shared"]:
    """Return the parameters of the rig at each view."""
    start = sum(term.count for term in model.base)
    found = np.tile(values[:start], (model.forms.views, 1))
    for one in chosen:
        width = sum(term.count for term in one.terms)
        if one.check in CHANGES:
            found[list(one.views)] += model.in_rig(one.terms[0].columns, values[start : start + width])
        start += width
    return found


def _cameras(model: ShootModel, values: Float64[np.ndarray, " shared"]) -> tuple[Camera, ...] | None:
    """Return the cameras after a step of their parameters; None where it leads to no possible camera."""
    dots = np.zeros((0, 3))
    state = RigState(tuple(model.rig.camera(name) for name in model.names), np.zeros((0, 4, 4)), dots)
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((0, 0))))
    try:
        return layout.stepped(values, np.zeros((0, 6))).cameras
    except InputError:
        return None
