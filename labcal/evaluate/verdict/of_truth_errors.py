"""The verdict on the errors of points against a truth, by rules."""

from math import isfinite, isnan

import numpy as np

from labcal.estimators.expected_error import LEAST_COVERAGE
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.verdict.amounts import at_distance, millimetres, percent
from labcal.evaluate.verdict.finding import Finding, Rules
from labcal.evaluate.verdict.shared_doubts import circular, not_one_ok, unknown_origin
from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.wording import counted

MOST_OVER_LIMIT = 2.0
"""Times what pixels leave from which on something else than noise is at work."""
MOST_SHIFT = 0.5
"""Mean error with its sign over the RMS error from which on errors are systematic."""


def truth_verdict(errors: TruthErrors, distance_mm: float | None = None) -> Verdict:
    """Return what the errors of points, against a known truth, promise for other points.

    Parameters
    ----------
    errors : TruthErrors
    distance_mm : float, optional
        Of the points from the cameras, where these are known.
    """
    return _RULES.verdict(errors, _expectation(errors, distance_mm), _leaves_out(errors))


def over_limit(errors: TruthErrors) -> float:
    """Return how many times the limit of triangulation the RMS error is; NaN where that is not known."""
    return errors.rmse_mm / errors.limit_mm if errors.limit_mm > 0.0 else float("nan")


def shift(errors: TruthErrors) -> float:
    """Return the length of the mean error, with signs, over the RMS error."""
    length = float(np.linalg.norm(errors.mean_signed_mm))
    return length / errors.rmse_mm if errors.rmse_mm > 0.0 else 0.0


def _expectation(errors: TruthErrors, distance_mm: float | None) -> str:
    return (
        f"a 3-D error of {millimetres(errors.rmse_mm)} (RMS; 95% of points within "
        f"{millimetres(errors.p95_mm)}){at_distance(distance_mm)}, as of {counted(errors.n, 'point')} in "
        f"{counted(len(errors.views_scored), 'view')}"
    )


def _not_one_ok(errors: TruthErrors) -> Finding | None:
    return not_one_ok(errors.n_ok)


def _circular(errors: TruthErrors) -> Finding | None:
    return circular(errors.views_calibrated_on)


def _too_large(errors: TruthErrors) -> Finding | None:
    times = over_limit(errors)
    if not times > MOST_OVER_LIMIT:
        return None
    return Finding(
        Belief.PARTLY,
        f"errors are {times:.1f} times what the noise of the pixels leaves",
        "the lens model or the method, not the noise",
        "look where the errors are, and try `lens='auto'` or the method 'hybrid'",
    )


def _shifted(errors: TruthErrors) -> Finding | None:
    share = shift(errors)
    if not share > MOST_SHIFT:
        return None
    x, y, z = errors.mean_signed_mm
    return Finding(
        Belief.PARTLY,
        f"most of the error is one and the same for all points, ({x:+.2g}, {y:+.2g}, {z:+.2g}) mm",
        "a systematic shift",
        "look for its cause: the place of the stage, the scale of the target, a camera that moved",
    )


def _overconfident(errors: TruthErrors) -> Finding | None:
    if isnan(errors.coverage95) or errors.coverage95 >= LEAST_COVERAGE:
        return None
    return Finding(
        Belief.PARTLY,
        f"the stated 95% ellipsoids hold only {percent(errors.coverage95)} of the points",
        "something that the stated sigma does not hold",
        "take the RMS error here, not the stated sigma, for the uncertainty of a point",
    )


def _not_known_from(errors: TruthErrors) -> Finding | None:
    return None if "test" in errors.scored else unknown_origin(errors.views_calibrated_on)


def _sound(errors: TruthErrors) -> Finding:
    times = over_limit(errors)
    reason = f"{counted(len(errors.views_scored), 'view')} that the calibration has not seen"
    if not isnan(errors.coverage95):
        reason += f", and the stated 95% ellipsoids hold {percent(errors.coverage95)}"
    if not isfinite(times):
        return Finding(
            Belief.YES, reason, "not told without the dots", "give `detections`, which tells noise from model"
        )
    limit = (
        f"the noise of the dots: the error is {times:.2f} times what triangulation by exact cameras leaves"
    )
    return Finding(
        Belief.YES, reason, limit, "measure (more light, larger dots or a wider baseline make it smaller)"
    )


def _leaves_out(errors: TruthErrors) -> list[str]:
    left = []
    if errors.alignment == "rigid":
        left.append(
            "an error of the whole frame: the points were brought onto the truth by a rigid motion first"
        )
    if errors.not_scored:
        left.append(
            f"{counted(errors.not_scored, 'point')} that were not scored; scored were {errors.scored}"
        )
    left.append("places where no scored point was")
    left.append(
        "what a real laboratory adds to the rendered one: temperature, a print that is not as declared"
    )
    return left


_RULES = Rules[TruthErrors](
    doubts=(_not_one_ok, _circular, _too_large, _shifted, _overconfident, _not_known_from),
    sound=_sound,
)
