"""A rig and its figures, assembled from the adjustment of all cameras together."""

import numpy as np

from labcal.calibrate.agreeing_views import SingleCameras
from labcal.calibrate.agreement.finding import Disagreement
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.calibrate.budget.rig_record import with_covariance
from labcal.calibrate.camera_covariance import CameraCovariance
from labcal.calibrate.dot_treatment import DotDecision
from labcal.calibrate.eccentricity import CorrectedEccentricity, centred
from labcal.calibrate.handheld_calibration import CameraFit, CameraSigma, HandheldCalibration
from labcal.calibrate.lens_misfit import lens_misfit
from labcal.calibrate.lens_prior import PriorWidth
from labcal.calibrate.lens_support import undetermined
from labcal.calibrate.outlying_dots import OutlyingDots
from labcal.calibrate.resection.resected import MOST_OFF
from labcal.calibrate.rig_residuals import RigResiduals
from labcal.calibrate.single_calibration import AdjustedDots
from labcal.calibrate.support_record import support_record
from labcal.calibrate.systematic_residual import systematic_residual
from labcal.calibrate.triangulation_check import calibration_record
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.kept_target import target_record
from labcal.targets.places import DotPlaces

_MOST_DOTS = 20_000
"""Measurements from which the triangulation residual is found, about: more add nothing."""


def recorded_rig(
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


def refuse_far(whole: AdjustedDots, entering: Detections, target: AnyTarget) -> None:
    """Raise where the rig's dots are nowhere near where they were measured."""
    rms = whole.adjusted.rms_px(whole.observations)
    widths = [entering.picture_size(name)[0] for name in entering.cameras]
    if not (rms <= MOST_OFF * np.array(widths)).all():  # of NaN, too
        raise InputError(
            f"No rig explains the dots: the adjustment left them off by {float(rms.max()):.3g} px. Check "
            f"that pictures show the target '{target.name}', and that those of a view were taken together."
        )


def assembled_rig(
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
