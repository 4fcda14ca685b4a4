"""The lens model where none is named: the usual one, unless the views ask for another."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld, calibrate_prepared
from labcal.calibrate.handheld_calibration import UNEVEN, UNEVEN_PX, HandheldCalibration
from labcal.calibrate.lens_candidates import DEFAULT_LENS, LARGE
from labcal.calibrate.lens_choice import MIN_VIEWS, LensCandidates, LensChoice, choose_lens
from labcal.calibrate.prepared_cameras import PreparedCameras, PreparedDots, prepared_cameras, prepared_dots
from labcal.calibrate.single_calibration import SingleCalibration, calibrate_single
from labcal.cameras.lens import FISHEYE
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.run.progress import Progress
from labcal.targets.catalogue import AnyTarget

Whole = Callable[[str], HandheldCalibration]
"""Calibrates a rig with a lens model by name."""
_OF_LARGER = (DEFAULT_LENS, "rational8", LARGE, FISHEYE)
"""Candidates where coefficients are missing; :data:`LARGE` only where its own are."""
_OF_WIDE = ("rational8", FISHEYE)
"""Candidates where a fisheye explains far more of the dots' places."""
_FAR_BETTER = 0.7
"""Ratio of RMS residuals of one camera, the fisheye's over the usual lens's, below which it is tried. With a
perspective lens on both sides of it, the two explain dots alike."""


def calibrate_with_default_lens(
    detections: Detections,
    target: AnyTarget,
    settings: HandheldSettings,
    progress: Progress,
    whole: Whole | None = None,
) -> tuple[LensChoice, HandheldCalibration]:
    """Calibrate with :data:`DEFAULT_LENS`, and look for another lens where the views ask for one.

    A wide lens is noticed first: each camera alone leaves large residuals, or none is found, and a fisheye
    explains the dots far better. Else the rig is calibrated, and missing coefficients are tested
    (:func:`~labcal.calibrate.lens_misfit.lens_misfit`). In both cases held-out views choose among a few
    models, the usual one among them. Where nothing is noticed, nothing is tried.

    Parameters
    ----------
    detections : Detections
        Only dots flagged ``ok`` enter.
    target : AnyTarget
    settings : HandheldSettings
        Without a rig to start from.
    progress : Progress
        Of the choice of a lens.
    whole : callable, optional
        Calibrates the rig with a lens model by name, where that takes more than these dots of a target.

    Raises
    ------
    InputError, ContradictionError
        As of :func:`~labcal.calibrate.handheld.calibrate_handheld`.
    """

    def of_target(lens: str) -> HandheldCalibration:
        return calibrate_handheld(detections, target, lens, settings)

    rig = whole or of_target
    dots = prepared_dots(detections, target, settings)
    try:
        usual: PreparedCameras | InputError = prepared_cameras(dots, target, DEFAULT_LENS, settings)
    except InputError as error:
        usual = error
    if _is_wide(usual, dots, target, settings):
        choice = _chosen_wide(detections, target, settings, progress)
        return choice, rig(choice.lens)
    if isinstance(usual, InputError):
        raise usual
    found = calibrate_prepared(usual, target, settings) if whole is None else whole(DEFAULT_LENS)
    if all(fit.misfit is None for fit in found.fits.values()):
        return LensChoice(DEFAULT_LENS, (), _why_usual(found)), found
    return _chosen_larger(detections, target, (settings, progress), (found, rig))


def _is_wide(
    usual: PreparedCameras | InputError, dots: PreparedDots, target: AnyTarget, settings: HandheldSettings
) -> bool:
    """Tell whether a fisheye explains the dots of a camera far better than the usual lens."""
    as_declared = replace(settings, dot_places=DotTreatment.DECLARED)
    for number, name in enumerate(dots.cameras):
        one = None if isinstance(usual, InputError) else usual.alone[number]
        if one is not None and not _leaves_much(one):
            continue
        try:
            fisheye = calibrate_single(name, dots.entering, target, FISHEYE, as_declared).result.adjusted
        except InputError:
            continue
        if one is None or fisheye.typical_px < _FAR_BETTER * one.result.adjusted.typical_px:
            return True
    return False


def _leaves_much(one: SingleCalibration) -> bool:
    """Tell whether the dots of a camera scatter far more than their noise."""
    covariance = one.dots.covariance
    noise = float(np.sqrt(0.5 * np.median(np.trace(covariance, axis1=1, axis2=2))))
    return one.result.adjusted.scatter_px > max(UNEVEN_PX, UNEVEN * noise)


def _chosen_wide(
    detections: Detections, target: AnyTarget, settings: HandheldSettings, progress: Progress
) -> LensChoice:
    """Choose the lens of wide cameras, with the dots as declared unless they are to be freed."""
    first = f"a fisheye explains the dots far better than '{DEFAULT_LENS}'"
    try:
        choice = choose_lens(detections, target, settings, progress, LensCandidates(_OF_WIDE))
    except InputError:  # too few views, or none is determined without some of them
        return LensChoice(FISHEYE, (), f"{first}; there are too few views to compare more models")
    return replace(choice, why=f"{first}; of the models tried, {choice.why}")


def _chosen_larger(
    detections: Detections,
    target: AnyTarget,
    how: tuple[HandheldSettings, Progress],
    usual: tuple[HandheldCalibration, Whole],
) -> tuple[LensChoice, HandheldCalibration]:
    """Choose among larger lenses, with the dots treated as with the usual one, and calibrate with it."""
    (settings, progress), (found, whole) = how, usual
    misfits = {name: fit.misfit for name, fit in found.fits.items() if fit.misfit is not None}
    first = "; ".join(
        f"the views of {name} ask for '{misfit.larger}' (p = {misfit.chance:.1g})"
        for name, misfit in misfits.items()
    )
    treated = replace(settings, dot_places=found.dot_decision.treatment)
    try:
        needed = tuple({misfit.larger for misfit in misfits.values()})
        lenses = tuple(lens for lens in _OF_LARGER if lens != LARGE or LARGE in needed)
        choice = choose_lens(detections, target, treated, progress, LensCandidates(lenses, needed))
        if choice.lens == DEFAULT_LENS:
            why = f"{first}, but held-out views are predicted as well without"
            return replace(choice, why=why), found
        again = whole(choice.lens)
    except InputError as error:
        return LensChoice(DEFAULT_LENS, (), f"{first}, but no larger model can be tried. {error}"), found
    return replace(choice, why=f"{first}; chosen: {choice.why}"), again


def _why_usual(found: HandheldCalibration) -> str:
    """Return the reason to keep the usual lens, for people."""
    fewest = min(len(fit.views) for fit in found.fits.values())
    if fewest < MIN_VIEWS:
        return f"the usual one; {fewest} views of a camera are too few to compare it with others"
    return "the usual one, and the views ask for no more coefficients"
