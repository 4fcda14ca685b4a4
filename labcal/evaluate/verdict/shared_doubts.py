"""Doubts that several kinds of results share; each returns a finding where it applies."""

from collections.abc import Sequence

from labcal.evaluate.verdict.finding import Finding
from labcal.evaluate.verdict.verdict import Belief

_NOT_KNOWN = "not known from these views"


def contradiction(causes: Sequence[str]) -> Finding | None:
    """Return the doubt about views that contradict each other; `causes` has the likeliest first."""
    if not causes:
        return None
    return Finding(
        Belief.NO,
        f"the views contradict each other, most likely {causes[0]}",
        "this contradiction, not noise",
        "read the likely causes and take the views that show them anew",
    )


def not_one_ok(count: int) -> Finding | None:
    """Return the doubt about points of which none is flagged ``ok``; `count` is how many are."""
    if count:
        return None
    return Finding(
        Belief.NO,
        "not one of the scored points is flagged 'ok'",
        "what the flags of the points say",
        "read the flags, and calibrate or fit again",
    )


def circular(views_calibrated_on: int | None) -> Finding | None:
    """Return the doubt about scored views that the calibration has seen; given is their number, if known."""
    if not views_calibrated_on:
        return None
    return Finding(
        Belief.NO,
        "the cameras come from these very views: this shows how well they repeat, not how true they are",
        _NOT_KNOWN,
        "score other views: `hold_out=2` of 'calibrate' or 'fit' keeps two",
    )


def unknown_origin(views_calibrated_on: int | None) -> Finding | None:
    """Return the doubt where it is not known (None) how many scored views the calibration has seen."""
    if views_calibrated_on is not None:
        return None
    return Finding(
        Belief.PARTLY,
        "it is not known whether the cameras were calibrated from these views",
        _NOT_KNOWN,
        "state what the points were reconstructed with: `rig`",
    )
