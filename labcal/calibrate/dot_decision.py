"""The decision to free the dots, by held-out views and by the certainty of the cameras."""

from collections.abc import Callable
from dataclasses import replace

from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.print_share import PrintShare
from labcal.calibrate.calibration_error import calibration_variance
from labcal.calibrate.dot_treatment import DotDecision, DotTreatment
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.held_out_dots import FOLDS, BothWays, HeldOutDots, held_out_dots
from labcal.calibrate.single_calibration import HandheldSettings, SingleCalibration
from labcal.cameras.lens import lens_by_name
from labcal.errors import InputError
from labcal.targets.catalogue import AnyTarget

MIN_VIEWS = 5
"""Of every camera: held-out views leave others that show each dot three times."""
MOST_DOTS = 600
"""Dots that are freed without being asked to: their normal equations are solved in every fold."""
UNEVEN = 3.0
"""Standard normal deviate of the score test from which on a print may be uneven."""
CHANCE = 0.01
"""Most probable chance of an advantage in held-out views."""
_FIRST_FOLDS, _SURE_CHANCE = 2, 1e-4
"""Number of parts of the views after which no more are held out, and the chance below which this is so."""

Calibrate = Callable[[list[SingleCalibration], DotDecision], HandheldCalibration]
"""Calibrates the rig, of cameras that are calibrated alone with their dots treated as is decided."""


def decision_at_once(
    cameras: list[SingleCalibration], target: AnyTarget, settings: HandheldSettings
) -> DotDecision | None:
    """Return the decision where it needs no second calibration: as asked, or for want of views or evidence.

    Parameters
    ----------
    cameras : list of SingleCalibration
        Each calibrated alone from all its views, with the dots as declared.
    target : AnyTarget
    settings : HandheldSettings
    """
    asked = DotTreatment(settings.dot_places)
    if settings.places is not None:
        return DotDecision(asked, DotTreatment.DECLARED, "where they were measured before")
    if asked is DotTreatment.DECLARED:
        return DotDecision(asked, asked, "as declared, as asked")
    if asked is DotTreatment.FREED:
        return DotDecision(asked, asked, "freed, as asked")
    hindrance = _hindrance(cameras, target, settings)
    if hindrance is not None:
        return DotDecision(asked, DotTreatment.DECLARED, f"as declared: {hindrance}")
    found = _as_declared(cameras)
    return None if (found.unevenness or 0.0) > UNEVEN else found


def judged(
    cameras: list[SingleCalibration], target: AnyTarget, settings: HandheldSettings, calibrate: Calibrate
) -> HandheldCalibration:
    """Return the better one of both calibrations where the residuals show an uneven print.

    Dots are freed if two things hold. Points become more certain: what more unknowns take from the cameras
    is less than what the errors of the print do to them, by the covariances of both calibrations. And
    held-out views are predicted better with the dots freed (Student's t-test).

    Parameters
    ----------
    cameras : list of SingleCalibration
        As of :func:`decision_at_once`.
    target : AnyTarget
    settings : HandheldSettings
    calibrate : callable

    Raises
    ------
    InputError
        The calibration with the dots as declared fails, and the dots are not freed.
    """
    kept = _as_declared(cameras)
    try:
        as_declared: HandheldCalibration | InputError = calibrate(cameras, kept)
    except InputError as error:
        as_declared = error
    chosen = as_declared
    try:
        on_print = [one.with_freed_dots(target, settings) for one in cameras]
        freed = calibrate(on_print, replace(kept, treatment=DotTreatment.FREED))
        found = _compared(freed, as_declared, target)
        if found.frees:
            found = _by_held_out_views(found, cameras, on_print, target)
        chosen = freed if found.frees else as_declared
    except InputError as error:
        found = replace(kept, why=f"as declared: the views cannot free the dots. {error}")
    if isinstance(chosen, InputError):
        raise chosen
    return replace(chosen, dot_decision=found)


def _as_declared(cameras: list[SingleCalibration]) -> DotDecision:
    """Return the decision to keep the dots, with the evidence of the residuals."""
    entered = [Entered.of(one.result.adjusted, one.result.observations) for one in cameras]
    known = [one for one in entered if one.with_fixed_dots().reduced is not None]
    return DotDecision(
        DotTreatment.AUTO,
        DotTreatment.DECLARED,
        "as declared: the residuals show no uneven print",
        unevenness=float(max((PrintShare.of_declared(one).unevenness for one in known), default=0.0)),
    )


def _compared(
    freed: HandheldCalibration, as_declared: HandheldCalibration | InputError, target: AnyTarget
) -> DotDecision:
    """Return the decision by the certainty of points."""
    if isinstance(as_declared, InputError):
        return freed.dot_decision
    ratio = calibration_variance(freed, target) / calibration_variance(as_declared, target)
    found = replace(freed.dot_decision, variance_ratio=ratio)
    if ratio < 1.0:
        return found
    why = (
        "as declared: the residuals show an uneven print, but freeing the dots would multiply the variance "
        f"of points by {ratio:.2g}"
    )
    return replace(found, treatment=DotTreatment.DECLARED, why=why)


def _by_held_out_views(
    found: DotDecision,
    cameras: list[SingleCalibration],
    on_print: list[SingleCalibration],
    target: AnyTarget,
) -> DotDecision:
    """Return the decision by the prediction of held-out views."""
    both_ways = [
        BothWays(one.result.adjusted, other.result.adjusted, one.result.observations, target, one.dots.views)
        for one, other in zip(cameras, on_print, strict=True)
    ]
    predicted: list[HeldOutDots] = []
    for number in range(FOLDS):
        parts = [held_out_dots(both, number) for both in both_ways]
        predicted += [part for part in parts if part is not None]
        if number + 1 >= _FIRST_FOLDS and HeldOutDots.joined(predicted).chance < _SURE_CHANCE:
            break
    held = HeldOutDots.joined(predicted)
    found = replace(found, declared_px=held.declared_px, freed_px=held.freed_px, chance=held.chance)
    figures = f"RMS {held.freed_px:.3g} px, {held.declared_px:.3g} px as declared, p = {held.chance:.1g}"
    if held.chance < CHANCE:
        why = f"freed: the print is uneven, and held-out views are predicted better so ({figures})"
        return replace(found, why=why)
    why = f"as declared: held-out views are predicted no better with the dots freed ({figures})"
    return replace(found, treatment=DotTreatment.DECLARED, why=why)


def _hindrance(cameras: list[SingleCalibration], target: AnyTarget, settings: HandheldSettings) -> str | None:
    """Return the reason why dots are not freed whatever the residuals are."""
    if settings.lenses is Lenses.FIXED:
        return "the lenses are kept"
    if any(lens_by_name(one.single.camera.lens).parallel for one in cameras):
        return "behind parallel rays an uneven print and a tilt are not distinguishable"
    if target.symmetric_indices(target.indices()[:1]):
        return "the target looks the same when turned"
    if target.count > MOST_DOTS:
        return f"a target of more than {MOST_DOTS} dots is freed only when asked to, since it takes long"
    fewest = min(len(one.dots.views) for one in cameras)
    if fewest < MIN_VIEWS:
        return f"{fewest} views of a camera are too few to judge by, {MIN_VIEWS} are needed"
    return None
