"""Calibration of cameras from a hand-held target: bundle adjustment with free target poses.

OpenCV starts (Zhang 2000). Each camera is then adjusted alone with all views that it measured, and the rig
with all views of all cameras. The first camera's frame is the world. Dots weigh by their covariances, and by
what they scatter beyond them; the eccentricity of dots is subtracted.
"""

from dataclasses import replace

import numpy as np

from labcal.calibrate.adjustment.observations import observations_of
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.agreeing_views import SingleCameras, of_agreeing_views
from labcal.calibrate.agreement.causes import Calibrated, disagreement
from labcal.calibrate.agreement.finding import ContradictionError
from labcal.calibrate.assembled import assembled_rig, recorded_rig, refuse_far
from labcal.calibrate.dot_decision import decision_at_once, judged
from labcal.calibrate.dot_treatment import DotDecision, DotTreatment
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_start import require_adjustable
from labcal.calibrate.one_lens import two_lenses
from labcal.calibrate.parallel_rig import with_determined_poses
from labcal.calibrate.prepared_cameras import PreparedCameras, prepared_cameras, prepared_dots
from labcal.calibrate.rig_start import rig_start
from labcal.calibrate.single_calibration import (
    AdjustedDots,
    HandheldSettings,
    SingleCalibration,
    adjusted,
    calibrate_single,
)
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.run.threads import one_blas_thread
from labcal.targets.catalogue import AnyTarget

__all__ = ["HandheldSettings", "calibrate_handheld"]


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
        Its dots are flat and exactly placed, unless the settings or held-out views free them.
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
    ContradictionError
        Cameras contradict each other so much that no rig explains the dots.
    """
    settings = settings or HandheldSettings()
    require_adjustable(lens)
    dots = prepared_dots(detections, target, settings)
    return calibrate_prepared(prepared_cameras(dots, target, lens, settings), target, settings)


def calibrate_prepared(
    cameras: PreparedCameras, target: AnyTarget, settings: HandheldSettings
) -> HandheldCalibration:
    """Calibrate a rig of cameras that are calibrated alone.

    Raises
    ------
    InputError, ContradictionError
        As of :func:`calibrate_handheld`.
    """
    alone, lens, dots = cameras.alone, cameras.lens, cameras.dots
    decision = decision_at_once(alone, target, settings)

    def calibrated(ready: list[SingleCalibration], by: DotDecision) -> HandheldCalibration:
        how = replace(settings, dot_places=by.treatment)
        return _calibrated(SingleCameras(ready, dots.entering, dots.left_out), target, lens, how, by)

    if decision is None:
        return judged(alone, target, settings, calibrated)
    if decision.frees:
        alone = [one.with_freed_dots(target, settings) for one in alone]
    return calibrated(alone, decision)


def _calibrated(
    alone: SingleCameras, target: AnyTarget, lens: str, settings: HandheldSettings, decision: DotDecision
) -> HandheldCalibration:
    """Calibrate the rig with cameras that are calibrated alone, their dots treated as is decided."""

    def single(name: str, dots: Detections) -> SingleCalibration:
        return calibrate_single(name, dots, target, lens, settings)

    def flat(name: str, dots: Detections) -> SingleCalibration:
        as_declared = replace(settings, dot_places=DotTreatment.DECLARED)
        return calibrate_single(name, dots, target, lens, as_declared)

    agreeing = of_agreeing_views(alone, target, single, free_dots=decision.frees)
    entering = agreeing.entering
    found = _with_lens_groups(agreeing.cameras, target, settings)
    if len(found) == 1:
        return assembled_rig(
            replace(agreeing, cameras=found), found[0].result, target, decision, settings.places
        )
    try:
        whole = _whole(found, entering, target, settings)
    except InputError as error:
        alike = [flat(camera.name, entering) for camera in found] if decision.frees else found
        doubt = disagreement(Calibrated(alike, entering, flat))
        if doubt is None:
            raise
        raise ContradictionError(doubt, _rms_alone(alike)) from error
    if whole.freed is not None:
        found_on_print = [camera.on_print(whole.freed, settings) for camera in found]
        doubt = disagreement(Calibrated(found_on_print, entering, flat, free_dots=True))
    else:
        doubt = disagreement(Calibrated(found, entering, single))
    rig_found = assembled_rig(replace(agreeing, cameras=found), whole, target, decision, settings.places)
    kept = settings.start_rig if settings.lenses is Lenses.FIXED else None
    return replace(
        rig_found, disagreement=doubt, rig=recorded_rig(rig_found, entering, target, (doubt, kept))
    )


def _whole(
    found: list[SingleCalibration], entering: Detections, target: AnyTarget, settings: HandheldSettings
) -> AdjustedDots:
    """Adjust the rig; raise where that fails, or ends in what is no rig."""
    cameras = tuple(camera.name for camera in found)
    observations = observations_of(entering, target, cameras, entering.views)
    start = rig_start(
        with_determined_poses([camera.single for camera in found], settings.start_rig),
        settings.dots_of(target),
    )
    whole = adjusted(start, observations, target, settings)
    refuse_far(whole, entering, target)
    Rig.of(dict(zip(cameras, whole.adjusted.state.cameras, strict=True)))  # raises beyond bounds of sense
    return whole


def _rms_alone(found: list[SingleCalibration]) -> float:
    """Return OpenCV's RMS over cameras that were calibrated alone, px."""
    residuals = [one.result.adjusted.residual[~one.result.adjusted.outlier] for one in found]
    return float(np.sqrt((np.concatenate(residuals) ** 2).sum(axis=1).mean()))


def _with_lens_groups(
    found: list[SingleCalibration], target: AnyTarget, settings: HandheldSettings
) -> list[SingleCalibration]:
    """Return the cameras with the groups of their views that were taken through different lenses."""
    if settings.lenses is Lenses.FIXED or any(one.single.camera.model.parallel for one in found):
        return found
    return [
        replace(
            one,
            two_lenses=two_lenses(
                one.result.adjusted,
                one.result.observations,
                one.dots.views,
                target,
                settings.eccentricity_rounds,
            ),
        )
        for one in found
    ]
