"""Calibration of cameras from a hand-held target: bundle adjustment with free target poses.

OpenCV starts (Zhang 2000). Each camera is then adjusted alone with all views that it measured, and the rig
with all views of all cameras. The first camera's frame is the world. Dots weigh by their covariances, and by
what they scatter beyond them; what a centroid of area is off the image of the centre is taken off.
"""

from dataclasses import dataclass, replace

import numpy as np

from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.solve.adjustment.free_dots import adjust_dots
from labcal.solve.adjustment.observations import Observations, observations_of
from labcal.solve.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.solve.adjustment.state import Freedom, Lenses, RigState
from labcal.solve.blas_threads import one_blas_thread
from labcal.solve.calibration import CameraFit, CameraSigma, HandheldCalibration
from labcal.solve.centre_bias import ROUNDS, CentreBias
from labcal.solve.freed_dots import FreedDots
from labcal.solve.lens_prior import PriorWidth
from labcal.solve.lens_start import (
    LensStart,
    camera_as_lens,
    require_adjustable,
    start_from_camera,
    start_from_pictures,
)
from labcal.solve.lens_support import undetermined
from labcal.solve.one_lens import TwoLenses, two_lenses
from labcal.solve.outlying_dots import OutlyingDots
from labcal.solve.resection.resected import MOST_OFF
from labcal.solve.rig_start import LoneCamera, rig_start
from labcal.solve.usable_dots import in_full_pictures, unmeasured_pictures, usable_dots
from labcal.solve.view_agreement import OddPicture, contradictions, seen_from_behind
from labcal.targets.catalogue import AnyTarget

MIN_VIEWS = 3
"""Views that a camera needs: two fix four intrinsics of a plane target, the third checks them."""

require_handheld_lens = require_adjustable


@dataclass(frozen=True)
class HandheldSettings:
    """How a hand-held target is used."""

    lenses: Lenses = Lenses.FREE
    """Whether lenses are estimated, or kept as `start` has them."""
    start: Rig | None = None
    """Where to begin; OpenCV begins where not given."""
    free_dots: bool = False
    """Whether the dots' places on the print are estimated."""
    bias_rounds: int = ROUNDS
    """How often centroid minus centre is predicted; 0 where the pixels are images of centres."""


@dataclass(frozen=True)
class _Result:
    """An adjustment of one camera or of several."""

    adjusted: Adjusted
    observations: Observations
    freed: FreedDots | None


@dataclass(frozen=True)
class _Alone:
    """A camera calibrated from all its views."""

    name: str
    dots: Detections
    result: _Result
    lone: LoneCamera
    """What the rig's adjustment takes from it."""
    two_lenses: TwoLenses | None = None


@one_blas_thread()
def calibrate_handheld(
    detections: Detections, target: AnyTarget, lens: str, settings: HandheldSettings | None = None
) -> HandheldCalibration:
    """Calibrate every camera in the detections, and their places relative to the first.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    target : AnyTarget
        Its dots are flat and exactly placed, unless the settings free them.
    lens : str
        Any lens model but a prescription.
    settings : HandheldSettings, optional

    Raises
    ------
    UnknownNameError
        There is no such lens model here.
    InputError
        A dot is not on the target, has no position or is listed twice, a camera has too few views or shares
        none with the rest of the rig, the dots determine no camera, or the rig to start from does not fit.
    """
    settings = settings or HandheldSettings()
    require_adjustable(lens)
    usable = usable_dots(detections, target)
    cameras = _require_all(usable, detections)
    entering, skipped = in_full_pictures(usable)
    skipped = (*unmeasured_pictures(detections), *skipped)
    found = [_alone(name, entering, target, lens, settings) for name in cameras]
    while odd := _odd_pictures(found, target):
        entering, reasons = _without(odd, entering)
        skipped += reasons
        found = [_alone(name, entering, target, lens, settings) for name in cameras]
    found = _told_apart(found, target, settings)
    if len(found) == 1:
        return _assemble(found, found[0].result, target, entering.views, skipped)
    observations = observations_of(entering, target, cameras, entering.views)
    start = rig_start([alone.lone for alone in found], target.points())
    whole = _adjusted(start, observations, target, settings)
    _refuse_far(whole, entering, target)
    return _assemble(found, whole, target, entering.views, skipped)


def _require_all(usable: Detections, detections: Detections) -> tuple[str, ...]:
    """Return the cameras; raise where one has pictures, but no dot that is a measurement."""
    for name in detections.cameras:
        if name not in usable.cameras:
            views = len(set(detections.view[detections.camera == name].tolist()))
            raise InputError(
                f"Camera '{name}' has {views} views, but not one dot with an id that is measured. See the "
                "flags in the detections; take its pictures anew, or leave them out."
            )
    return usable.cameras


def _refuse_far(whole: _Result, entering: Detections, target: AnyTarget) -> None:
    """Raise where the rig's dots are nowhere near where they were measured."""
    rms = whole.adjusted.rms_px(whole.observations)
    widths = [entering.picture_size(name)[0] for name in entering.cameras]
    if not (rms <= MOST_OFF * np.array(widths)).all():  # of NaN, too
        raise InputError(
            f"No rig explains the dots: the adjustment left them off by {float(rms.max()):.3g} px. Check "
            f"that pictures show the target '{target.name}', and that those of a view were taken together."
        )


def _alone(
    name: str, entering: Detections, target: AnyTarget, lens: str, settings: HandheldSettings
) -> "_Alone":
    """Calibrate one camera from all its views."""
    dots = entering.where(entering.camera == name)
    start = _lens_start(dots, name, target, lens, settings)
    state = RigState((start.camera,), start.T_cam_target, target.points())
    result = _adjusted(state, observations_of(dots, target, (name,), dots.views), target, settings)
    number = {view: place for place, view in enumerate(entering.views)}
    views = np.array([number[view] for view in dots.views], dtype=np.int64)
    end = result.adjusted.state
    return _Alone(name, dots, result, LoneCamera(name, end.cameras[0], views, end.T_world_target))


def _told_apart(found: list[_Alone], target: AnyTarget, settings: HandheldSettings) -> list[_Alone]:
    """Return the cameras with the groups of their views that were taken through different lenses."""
    if settings.lenses is Lenses.FIXED:
        return found
    return [
        replace(
            alone,
            two_lenses=two_lenses(
                alone.result.adjusted,
                alone.result.observations,
                alone.dots.views,
                target,
                settings.bias_rounds,
            ),
        )
        for alone in found
    ]


def _odd_pictures(found: list[_Alone], target: AnyTarget) -> list[OddPicture]:
    """Return the pictures that cannot be what they are said to be."""
    lone = [alone.lone for alone in found]
    odd = [picture for camera in lone for picture in seen_from_behind(camera)]
    if odd or len(lone) == 1:
        return odd
    return contradictions(lone, target.points())


def _without(odd: list[OddPicture], entering: Detections) -> tuple[Detections, tuple[str, ...]]:
    """Return what enters without odd pictures; and what does not, for people."""
    enters, reasons = np.full(len(entering), fill_value=True), []
    for picture in odd:
        view = entering.views[picture.view]
        enters &= ~((entering.view == view) & (entering.camera == picture.camera))
        reasons.append(f"view '{view}' of camera '{picture.camera}': {picture.reason}")
    return entering.where(enters), tuple(reasons)


def _lens_start(
    dots: Detections, name: str, target: AnyTarget, lens: str, settings: HandheldSettings
) -> LensStart:
    """Return where a camera begins, from the rig to start from or from its own pictures."""
    needed = MIN_VIEWS if settings.lenses is Lenses.FREE else 1
    if len(dots.views) < needed:
        raise InputError(
            f"Camera '{name}' has {len(dots.views)} usable views, but needs {needed} at different tilts."
        )
    pictures = dots.by_view()
    size = dots.picture_size(name)
    if settings.start is None:
        if settings.lenses is Lenses.FIXED:
            raise InputError(
                "Intrinsics can be kept only where a rig to start from gives them. Add --start rig.json."
            )
        return start_from_pictures(pictures, target, lens)
    known = settings.start.camera(name)
    if known.size != size:
        raise InputError(
            f"Camera '{name}' of the rig to start from takes pictures of {known.size[0]} x {known.size[1]}, "
            f"but these are {size[0]} x {size[1]}."
        )
    return start_from_camera(pictures, target, camera_as_lens(known, lens, name))


def _adjusted(
    start: RigState, observations: Observations, target: AnyTarget, settings: HandheldSettings
) -> _Result:
    """Adjust with the dots as declared and, where asked, once more with free dots."""
    freedom = Freedom(settings.lenses, np.zeros((3 * target.count, 0)))
    radii = 0.5 * target.outer_diameters_mm()
    flat = adjust_in_rounds(start, observations, freedom, radii, settings.bias_rounds)
    if not settings.free_dots:
        return _Result(flat, observations, None)
    free = adjust_dots(flat, observations, target, settings.lenses, settings.bias_rounds)
    return _Result(free.adjusted, free.observations, free.dots)


def _assemble(
    found: list[_Alone], whole: _Result, target: AnyTarget, views: tuple[str, ...], skipped: tuple[str, ...]
) -> HandheldCalibration:
    """Return the rig and its figures."""
    adjusted = whole.adjusted
    in_rig = adjusted.rms_px(whole.observations)
    fits = {}
    for number, alone in enumerate(found):
        result = alone.result
        fits[alone.name] = CameraFit(
            rms_px=float(result.adjusted.rms_px(result.observations)[0]),
            rms_in_rig_px=float(in_rig[number]),
            views=alone.dots.views,
            dots=int((~result.adjusted.outlier).sum()),
            sigma=CameraSigma.of(adjusted, number),
            scatter_px=result.adjusted.scatter_px,
            freed=result.freed,
            undetermined=undetermined(result.adjusted, result.observations),
            open_lens=result.adjusted.prior_width is PriorWidth.NARROW,
            noise_px=float(np.sqrt(np.median(np.trace(alone.dots.covariance, axis1=1, axis2=2)) / 2.0)),
            two_lenses=alone.two_lenses,
        )
    names = tuple(alone.name for alone in found)
    cameras = zip(names, adjusted.state.cameras, strict=True)
    return HandheldCalibration(
        rig=Rig.of(dict(cameras)),
        fits=fits,
        rms_px=float(np.sqrt((adjusted.residual[~adjusted.outlier] ** 2).sum(axis=1).mean())),
        skipped=skipped,
        outliers=OutlyingDots.of(adjusted, whole.observations, target, (names, views)),
        views=views,
        T_world_target=adjusted.state.T_world_target,
        bias=CentreBias.of(adjusted.shift),
        freed=whole.freed,
        reason=adjusted.reason,
    )
