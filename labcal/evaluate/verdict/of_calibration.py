"""The verdict on a calibration, by rules."""

from dataclasses import dataclass
from math import hypot, isfinite

from labcal.evaluate.verdict.amounts import millimetres, percent, pixels
from labcal.evaluate.verdict.finding import Finding, Rules
from labcal.evaluate.verdict.shared_doubts import contradiction
from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.evaluate.working_distance import WorkingDistance
from labcal.wording import counted, listed

FEW_VIEWS = 6
"""Fewer views leave hardly anything to check a lens by."""
GOOD_VIEWS = 15
"""Views to take instead; see the page on how to shoot a good set."""
LEAST_COVERAGE = 0.4
"""Share of the cells of a picture with dots, below which most of the lens is extrapolated."""
MOST_OUTLIERS = 0.05
"""Share of the dots that did not enter from which on outliers are no accidents."""
MOST_DEPTH = 3.0
"""Times the error across from which on the error in depth is worth a word."""
MUCH_LARGER = 1.5
"""Times the error of shapes from which on that in the frame of the rig is worth a word."""
SCALE, _EXAMPLE_MM = 1e-3, 500.0
"""A relative error of the pitch and a length, for an example in millimetres."""


@dataclass(frozen=True)
class CalibrationEvidence:
    """Evidence for the rules.

    Attributes
    ----------
    at : WorkingDistance
        By the noise of pixels.
    calibration_mm : float
        RMS error of points there by the uncertainty of the cameras' parameters; NaN where it is not known.
    noise_px, scatter_px : float
        Of dots along each axis: by their covariances, and what is left beyond them.
    rms_px : float
    views, held_out : int
    outliers : float
        Share of dots.
    coverage : float
        Share of the picture with dots, of the camera that has least.
    causes : tuple of str
        Of contradictions, the likeliest first.
    two_lenses, open_lens, uneven, undetermined : tuple of str
        Names of cameras.
    finished : bool
        True if the adjustment came to its end.
    freed : bool
        True if the places of the dots on the print were estimated.
    parallel : bool
        True if the rays of a camera are parallel.
    baseline_mm : float
        Greatest distance of two cameras; 0 of one.
    in_frame_mm : float
        RMS 3-D error in the frame of the rig, with what moves all points together; NaN where it is not known.
    view_ratio : float
        Squared disagreement of the views about the cameras over what the noise of their dots explains; 1
        where chance explains it. The errors of the calibration are wider by it.
    """

    at: WorkingDistance
    calibration_mm: float
    noise_px: float
    scatter_px: float
    rms_px: float
    views: int
    held_out: int
    outliers: float
    coverage: float
    causes: tuple[str, ...] = ()
    two_lenses: tuple[str, ...] = ()
    open_lens: tuple[str, ...] = ()
    uneven: tuple[str, ...] = ()
    undetermined: tuple[str, ...] = ()
    finished: bool = True
    freed: bool = False
    parallel: bool = False
    baseline_mm: float = 0.0
    in_frame_mm: float = float("nan")
    view_ratio: float = 1.0

    @property
    def expected_mm(self) -> float:
        """RMS 3-D error by pixels and, where it is known, by the cameras' parameters."""
        return hypot(self.at.sigma_mm, self.calibration_mm if isfinite(self.calibration_mm) else 0.0)


def calibration_verdict(evidence: CalibrationEvidence) -> Verdict:
    """Return what to expect of points that are measured with a rig, and whether to believe it."""
    return _RULES.verdict(evidence, _expectation(evidence), _leaves_out(evidence))


def _expectation(evidence: CalibrationEvidence) -> str:
    at = evidence.at
    if not isfinite(at.distance_mm):
        return "nothing in millimetres, since no place of the target is seen by all cameras"
    where = f"at {millimetres(at.distance_mm)}, the distance at which the target was held"
    if evidence.parallel:
        where = "where the target was held (rays are parallel, so that the distance does not matter)"
    if not isfinite(at.sigma_mm):
        return f"{millimetres(at.across_mm)} across the view (1 sigma) {where}; one camera gives no depth"
    shape = f"a 3-D error of {millimetres(evidence.expected_mm)} (RMS, 1 sigma) {where}"
    if not evidence.in_frame_mm > MUCH_LARGER * evidence.expected_mm:  # of NaN, too
        return shape
    return (
        f"{shape}, of shapes and lengths, but of {millimetres(evidence.in_frame_mm)} in the frame of the "
        "rig, where errors of the calibration move all points together"
    )


def _contradiction(evidence: CalibrationEvidence) -> Finding | None:
    return contradiction(evidence.causes)


def _two_lenses(evidence: CalibrationEvidence) -> Finding | None:
    if not evidence.two_lenses:
        return None
    return Finding(
        Belief.NO,
        f"views of {listed(evidence.two_lenses)} were taken through two different lenses",
        "the mixture of two lenses",
        "tell the cameras apart with `cameras` of 'detect', or take all views without refocusing",
    )


def _unfinished(evidence: CalibrationEvidence) -> Finding | None:
    if evidence.finished:
        return None
    return Finding(
        Belief.NO,
        "the adjustment has not come to its end",
        "the adjustment",
        "take more views, or choose a lens model with fewer coefficients",
    )


def _nowhere(evidence: CalibrationEvidence) -> Finding | None:
    if isfinite(evidence.at.distance_mm):
        return None
    return Finding(
        Belief.NO,
        "no dot lies in the pictures of all cameras",
        "the views, which the cameras do not share",
        "hold the target where all cameras see it",
    )


def _few_views(evidence: CalibrationEvidence) -> Finding | None:
    if evidence.views >= FEW_VIEWS:
        return None
    return Finding(
        Belief.PARTLY,
        f"{counted(evidence.views, 'view')} leave hardly anything to check the cameras by",
        "the number of views",
        f"take {GOOD_VIEWS} views or more, tilted every way and up to the corners",
    )


def _open_lens(evidence: CalibrationEvidence) -> Finding | None:
    if not evidence.open_lens:
        return None
    return Finding(
        Belief.PARTLY,
        f"the dots leave the lens of {listed(evidence.open_lens)} open towards the border of the picture",
        "the part of the picture without dots",
        "take views with dots in the corners",
    )


def _uneven(evidence: CalibrationEvidence) -> Finding | None:
    if not evidence.uneven:
        return None
    return Finding(
        Belief.PARTLY,
        f"dots of {listed(evidence.uneven)} scatter by {pixels(evidence.scatter_px)} beyond their noise of "
        f"{pixels(evidence.noise_px)}",
        "the print or the lens model, not the noise of the pictures",
        "estimate the dots on the print with `dot_places='freed'`, or try `lens='auto'`",
    )


def _undetermined(evidence: CalibrationEvidence) -> Finding | None:
    if not evidence.undetermined:
        return None
    return Finding(
        Belief.PARTLY,
        f"the views of {listed(evidence.undetermined)} do not determine all coefficients of the lens",
        "the lens away from where dots were",
        "measure where dots were, or let `lens='auto'` choose a simpler lens",
    )


def _outliers(evidence: CalibrationEvidence) -> Finding | None:
    if evidence.outliers <= MOST_OUTLIERS:
        return None
    return Finding(
        Belief.PARTLY,
        f"{percent(evidence.outliers)} of the dots were set aside as outliers",
        "dots that do not fit",
        "look where the outliers are, and mend the light or the print there",
    )


def _uncovered(evidence: CalibrationEvidence) -> Finding | None:
    if evidence.coverage >= LEAST_COVERAGE:
        return None
    return Finding(
        Belief.PARTLY,
        f"dots cover only {percent(evidence.coverage)} of a picture",
        "the part of the picture without dots",
        "take views that fill the pictures up to the corners, or measure only where dots were",
    )


def _sound(evidence: CalibrationEvidence) -> Finding:
    """Return the finding where nothing is amiss: the largest part of the error is its limit."""
    at, calibration = evidence.at, evidence.calibration_mm
    if isfinite(calibration) and calibration > at.sigma_mm:
        limit = (
            f"how well {counted(evidence.views, 'view')} determine the cameras ({millimetres(calibration)})"
        )
        advice = "take more views to make it smaller"
    elif at.along_mm > MOST_DEPTH * at.across_mm:
        limit = (
            f"depth, at {at.along_mm / at.across_mm:.0f} times the error across: the cameras are "
            f"{millimetres(evidence.baseline_mm)} apart"
        )
        advice = "set the cameras farther apart, or come nearer, where depth matters"
    elif evidence.scatter_px > evidence.noise_px:
        limit = (
            f"what lens model and print leave, {pixels(evidence.scatter_px)} beyond the dots' noise of "
            f"{pixels(evidence.noise_px)}"
        )
        advice = "see whether `lens='auto'` makes it smaller"
        if not evidence.freed:
            advice = "see whether `dot_places='freed'` or `lens='auto'` makes it smaller"
    else:
        limit = f"the noise of the dots, {pixels(evidence.noise_px)}"
        advice = "measure"
    if not isfinite(at.sigma_mm):
        advice = "calibrate a second time from other views, and compare"
    elif not evidence.held_out:
        advice = "check it on views that it has not seen: `hold_out=2`, then 'labcal evaluate'"
    else:
        advice = (
            f"score the {counted(evidence.held_out, 'view')} held out with 'labcal evaluate', and {advice}"
        )
    views, residuals = counted(evidence.views, "view"), f"residuals of {pixels(evidence.rms_px)} (RMS)"
    reason = f"{views} without contradiction leave {residuals}"
    if evidence.view_ratio > 1.0:
        reason = (
            f"{views} leave {residuals}; they disagree about the cameras by more than noise "
            f"({evidence.view_ratio:.1f} times its squares), and the error above holds that"
        )
    return Finding(Belief.YES, reason, limit, advice)


def _leaves_out(evidence: CalibrationEvidence) -> list[str]:
    at = evidence.at
    left = []
    if not isfinite(evidence.calibration_mm):
        left.append("the uncertainty of the cameras' parameters: they count as exact")
    left.append(
        f"a wrong scale: a pitch that is {100 * SCALE:g}% too large makes every length {100 * SCALE:g}% too "
        f"large, {millimetres(SCALE * _EXAMPLE_MM)} in {millimetres(_EXAMPLE_MM)}"
    )
    held = f"between {millimetres(at.nearest_mm)} and {millimetres(at.farthest_mm)} away"
    left.append("places where the target was not" + ("" if evidence.parallel else f": it was held {held}"))
    if not evidence.freed:
        left.append("errors of the print: its dots count as declared; `dot_places='freed'` estimates them")
    left.append("an error of the lens model that all views share")
    left.append("whatever changes after the calibration: focus, temperature, a camera that is knocked")
    return left


_RULES = Rules[CalibrationEvidence](
    doubts=(
        _contradiction,
        _two_lenses,
        _unfinished,
        _nowhere,
        _uneven,
        _few_views,
        _open_lens,
        _undetermined,
        _outliers,
        _uncovered,
    ),
    sound=_sound,
)
