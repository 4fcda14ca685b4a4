"""The decision to free the dots, by held-out views and by the certainty of the cameras."""

from dataclasses import replace

import numpy as np

from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.calibrate.dot_treatment import DotDecision, DotTreatment
from labcal.calibrate.held_out_dots import BothWays, HeldOutDots, held_out_dots
from labcal.calibrate.single_calibration import AdjustedDots, HandheldSettings, SingleCalibration
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


def decide_dots(
    cameras: list[SingleCalibration], target: AnyTarget, settings: HandheldSettings
) -> tuple[DotDecision, list[SingleCalibration]]:
    """Decide whether the dots of a target are freed, and return the cameras calibrated by it.

    They are if three things hold. The residuals of a camera with the dots as declared show an uneven print
    (score test). The cameras become more certain: what more unknowns take from them is less than what the
    errors of the print do to them. And held-out views are predicted better with the dots freed (Student's
    t-test). The first costs next to nothing, so that nothing else is computed for an even print.

    Parameters
    ----------
    cameras : list of SingleCalibration
        Each calibrated alone from all its views, with the dots as declared.
    target : AnyTarget
    settings : HandheldSettings

    Raises
    ------
    InputError
        The dots are to be freed, and the views cannot.
    """
    asked = DotTreatment(settings.dot_places)
    if asked is DotTreatment.DECLARED:
        return DotDecision(asked, asked, "as declared, as asked"), cameras
    if asked is DotTreatment.FREED:
        freed = [one.with_freed_dots(target, settings) for one in cameras]
        return DotDecision(asked, asked, "freed, as asked"), freed
    hindrance = _hindrance(cameras, target, settings)
    if hindrance is not None:
        return DotDecision(asked, DotTreatment.DECLARED, f"as declared: {hindrance}"), cameras
    sources = [ErrorSources.of(one.result.adjusted, one.result.observations, None) for one in cameras]
    decision, freed = _judged(cameras, sources, target, settings)
    return decision, freed if decision.frees else cameras


def _judged(
    cameras: list[SingleCalibration],
    sources: list[ErrorSources],
    target: AnyTarget,
    settings: HandheldSettings,
) -> tuple[DotDecision, list[SingleCalibration]]:
    """Return the decision by residuals, and the cameras with the dots freed where this was tried."""
    shares = [one.print_share for one in sources if one.print_share is not None]
    kept = DotDecision(
        DotTreatment.AUTO,
        DotTreatment.DECLARED,
        "as declared: the residuals show no uneven print",
        unevenness=float(max((share.unevenness for share in shares), default=0.0)),
    )
    if not (kept.unevenness or 0.0) > UNEVEN:
        return kept, []
    try:
        freed = [one.with_freed_dots(target, settings) for one in cameras]
        found = replace(kept, variance_ratio=_variance_ratio(cameras, sources, freed))
        if not (found.variance_ratio or 0.0) < 1.0:
            why = (
                "as declared: the residuals show an uneven print, but freeing its dots would multiply the "
                f"variance of the cameras by {found.variance_ratio:.2g}"
            )
            return replace(found, why=why), freed
        held = _held_out(cameras, freed, target)
    except InputError as error:
        return replace(kept, why=f"as declared: the views cannot free them. {error}"), []
    found = replace(found, declared_px=held.declared_px, freed_px=held.freed_px, chance=held.chance)
    figures = f"RMS {held.freed_px:.3g} px, {held.declared_px:.3g} px as declared, p = {held.chance:.1g}"
    if not held.chance < CHANCE:
        why = f"as declared: held-out views are predicted no better with the dots freed ({figures})"
        return replace(found, why=why), freed
    why = f"freed: the print is uneven, and held-out views are predicted better so ({figures})"
    return replace(found, treatment=DotTreatment.FREED, why=why), freed


def _held_out(
    cameras: list[SingleCalibration], freed: list[SingleCalibration], target: AnyTarget
) -> HeldOutDots:
    """Return how well held-out views of all cameras are predicted."""
    found = []
    for one, other in zip(cameras, freed, strict=True):
        declared = one.result
        both = BothWays(
            declared.adjusted, other.result.adjusted, declared.observations, target, one.dots.views
        )
        found.append(held_out_dots(both))
    return HeldOutDots.joined(found)


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


def _variance_ratio(
    cameras: list[SingleCalibration], flat: list[ErrorSources], freed: list[SingleCalibration]
) -> float:
    """Return the variance of the cameras with freed dots over the one with declared dots.

    Each is the trace of the covariance times the information of pixels alone about the cameras, which is the
    variance that they cause in the pixels of the calibration's pictures, poses fitted (I-optimality).
    """
    found = []
    for one, sources, other in zip(cameras, flat, freed, strict=True):
        entered = Entered.of(other.result.adjusted, other.result.observations)
        spread = entered.with_fixed_dots().shared_spread()
        of_freed = ErrorSources.of(other.result.adjusted, other.result.observations, other.result.freed)
        found.append(
            [
                float(np.trace(np.linalg.solve(spread, _total(errors, result))))
                for errors, result in ((of_freed, other.result), (sources, one.result))
            ]
        )
    after, before = np.sum(found, axis=0)
    return float(after / before)


def _total(sources: ErrorSources, result: AdjustedDots) -> np.ndarray:
    free = result.adjusted.layout.pose[-1].stop
    return sources.total(result.adjusted.spread[:free, :free])
