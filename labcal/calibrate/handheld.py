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
from labcal.calibrate.agreement.finding import ContradictionError, Disagreement
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.calibrate.budget.rig_record import with_covariance
from labcal.calibrate.camera_covariance import CameraCovariance
from labcal.calibrate.dot_decision import decision_at_once, judged
from labcal.calibrate.dot_treatment import DotDecision, DotTreatment
from labcal.calibrate.eccentricity import CorrectedEccentricity, centred
from labcal.calibrate.handheld_calibration import CameraFit, CameraSigma, HandheldCalibration
from labcal.calibrate.lens_misfit import lens_misfit
from labcal.calibrate.lens_prior import PriorWidth
from labcal.calibrate.lens_start import require_adjustable
from labcal.calibrate.lens_support import undetermined
from labcal.calibrate.one_lens import two_lenses
from labcal.calibrate.outlying_dots import OutlyingDots
from labcal.calibrate.parallel_rig import with_determined_poses
from labcal.calibrate.prepared_cameras import PreparedCameras, prepared_cameras, prepared_dots
from labcal.calibrate.resection.resected import MOST_OFF
from labcal.calibrate.rig_residuals import RigResiduals
from labcal.calibrate.rig_start import rig_start
from labcal.calibrate.single_calibration import (
    AdjustedDots,
    HandheldSettings,
    SingleCalibration,
    adjusted,
    calibrate_single,
)
from labcal.calibrate.support_record import support_record
from labcal.calibrate.systematic_residual import systematic_residual
from labcal.calibrate.triangulation_check import calibration_record
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.errors import InputError
from labcal.run.threads import one_blas_thread
from labcal.targets.catalogue import AnyTarget
from labcal.targets.kept_target import target_record
from labcal.targets.places import DotPlaces

__all__ = ["HandheldSettings", "calibrate_handheld"]

_MOST_DOTS = 20_000
"""Measurements from which the triangulation residual is found, about: more add nothing."""


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
        return _assemble(replace(agreeing, cameras=found), found[0].result, target, decision, settings.places)
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
    rig_found = _assemble(replace(agreeing, cameras=found), whole, target, decision, settings.places)
    kept = settings.start_rig if settings.lenses is Lenses.FIXED else None
    return replace(rig_found, disagreement=doubt, rig=_recorded(rig_found, entering, target, (doubt, kept)))


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
    _refuse_far(whole, entering, target)
    Rig.of(dict(zip(cameras, whole.adjusted.state.cameras, strict=True)))  # raises beyond bounds of sense
    return whole


def _rms_alone(found: list[SingleCalibration]) -> float:
    """Return OpenCV's RMS over cameras that were calibrated alone, px."""
    residuals = [one.result.adjusted.residual[~one.result.adjusted.outlier] for one in found]
    return float(np.sqrt((np.concatenate(residuals) ** 2).sum(axis=1).mean()))


def _recorded(
    found: HandheldCalibration,
    entering: Detections,
    target: AnyTarget,
    of: tuple[Disagreement | None, Rig | None],
) -> Rig:
    """Return the rig with what its calibration left, by some of the views where there are very many.

    `of` holds the disagreement of the cameras and the rig that lenses were kept from.
    """
    doubt, kept = of
    dots = found.outliers.left_out(entering)
    some = dots.views[:: -(-len(dots) // _MOST_DOTS)]
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    matches = match(dots.where(np.isin(dots.view, some)), tuple(found.rig.cameras))
    if len(matches) and doubt is None:  # of a rig that fits nothing, points are nowhere near a target
        matches, _ = centred(cameras, matches, target)
    causes = () if doubt is None else tuple(cause.cause.value for cause in doubt.causes)
    record = calibration_record(cameras, matches, causes)
    if found.dot_decision.frees:
        record = record.model_copy(update={"dot_places": "freed"})
    if found.rig.covariance is not None and len(cameras) > 1 and len(matches):
        point = triangulate(cameras, matches.q, matches.covariance).point
        part = systematic_residual(cameras, matches, point, found.rig.covariance.matrix, record)
        record = record.model_copy(update={"systematic_px": None if part is None else part.rms_px})
    support = support_record(dots, target, found.views, found.T_world_target, kept)
    with_support = record.model_copy(update={"support": support})
    return found.rig.model_copy(update={"calibration": with_support})


def _refuse_far(whole: AdjustedDots, entering: Detections, target: AnyTarget) -> None:
    """Raise where the rig's dots are nowhere near where they were measured."""
    rms = whole.adjusted.rms_px(whole.observations)
    widths = [entering.picture_size(name)[0] for name in entering.cameras]
    if not (rms <= MOST_OFF * np.array(widths)).all():  # of NaN, too
        raise InputError(
            f"No rig explains the dots: the adjustment left them off by {float(rms.max()):.3g} px. Check "
            f"that pictures show the target '{target.name}', and that those of a view were taken together."
        )


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


def _assemble(
    single: SingleCameras,
    whole: AdjustedDots,
    target: AnyTarget,
    decision: DotDecision,
    known: DotPlaces | None,
) -> HandheldCalibration:
    """Return the rig and its figures."""
    found, views = single.cameras, single.entering.views
    adjusted = whole.adjusted
    in_rig = adjusted.rms_px(whole.observations)
    sources = ErrorSources.of(adjusted, whole.observations, whole.freed, known)
    covariance = CameraCovariance.of(adjusted, sources)
    fits = {}
    for number, one in enumerate(found):
        result = one.result
        fits[one.name] = CameraFit(
            rms_px=float(result.adjusted.rms_px(result.observations)[0]),
            rms_in_rig_px=float(in_rig[number]),
            views=one.dots.views,
            dots=int((~result.adjusted.outlier).sum()),
            sigma=CameraSigma.of(adjusted, covariance, number),
            scatter_px=result.adjusted.scatter_px,
            freed=result.freed,
            undetermined=undetermined(result.adjusted, result.observations),
            open_lens=result.adjusted.prior_width is PriorWidth.NARROW,
            noise_px=float(np.sqrt(np.median(np.trace(one.dots.covariance, axis1=1, axis2=2)) / 2.0)),
            two_lenses=one.two_lenses,
            misfit=lens_misfit(result.adjusted, result.observations),
        )
    names = tuple(one.name for one in found)
    cameras = zip(names, adjusted.state.cameras, strict=True)
    rig = Rig.of(dict(cameras)).model_copy(update={"target": target_record(target)})
    return HandheldCalibration(
        rig=with_covariance(rig, adjusted, sources),
        fits=fits,
        rms_px=float(np.sqrt((adjusted.residual[~adjusted.outlier] ** 2).sum(axis=1).mean())),
        skipped=single.left_out,
        outliers=OutlyingDots.of(adjusted, whole.observations, target, (names, views)),
        views=views,
        T_world_target=adjusted.state.T_world_target,
        eccentricity=CorrectedEccentricity.of(adjusted.eccentricity),
        freed=whole.freed,
        reason=adjusted.reason,
        residuals=RigResiduals.of(adjusted, whole.observations),
        covariance=covariance,
        sources=sources,
        dots=adjusted.state.dots,
        measured_print=known is not None,
        dot_decision=decision,
    )
