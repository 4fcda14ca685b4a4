"""The verdict on the errors of lengths on the target, by rules."""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.verdict.amounts import at_distance, millimetres
from labcal.evaluate.verdict.finding import Finding, Rules
from labcal.evaluate.verdict.shared_doubts import circular, not_one_ok, unknown_origin
from labcal.evaluate.verdict.verdict import Belief, Verdict
from labcal.wording import counted

FEW_LENGTHS = 45
"""Between ten dots."""
MOST_BEYOND = 5.0
"""Times the 99th percentile from which on single points are bad.

Errors of lengths are a mixture: those in depth are several times as large as those across. Their greatest is
therefore many times the RMS, but not the 99th percentile, which a single bad point hardly moves.
"""
_ALMOST_ALL = 99.0
MOST_SCALE_SHARE = 0.7
"""Of the RMS error, from which on the scale is half of the mean square."""


def length_verdict(errors: LengthErrors, longest_mm: float, distance_mm: float | None = None) -> Verdict:
    """Return what the errors of lengths on the target promise for other lengths.

    Parameters
    ----------
    errors : LengthErrors
    longest_mm : float
        The longest length that was compared.
    distance_mm : float, optional
        Of the target from the cameras, where these are known.
    """
    long = f" of up to {millimetres(longest_mm)}" if isfinite(longest_mm) else ""
    where = f"lengths{long}{at_distance(distance_mm)}"
    length = errors.length_error_mm
    expectation = (
        f"an error of {millimetres(length.rms)} (RMS; the greatest of {counted(errors.n, 'length')} is "
        f"{millimetres(length.max)}) in {where}"
    )
    return _RULES.verdict(_Lengths(errors, longest_mm), expectation, _LEAVES_OUT)


@dataclass(frozen=True)
class _Lengths:
    """Errors of lengths and the longest length, mm."""

    errors: LengthErrors
    longest_mm: float


def _not_one_ok(given: _Lengths) -> Finding | None:
    return not_one_ok(given.errors.n_ok)


def _circular(given: _Lengths) -> Finding | None:
    return circular(given.errors.views_calibrated_on)


def _few(given: _Lengths) -> Finding | None:
    if given.errors.n >= FEW_LENGTHS:
        return None
    return Finding(
        Belief.PARTLY,
        f"there is only {counted(given.errors.n, 'length')} to see how errors are spread",
        "the number of lengths",
        "score views with more dots",
    )


def _scale(given: _Lengths) -> Finding | None:
    scale_mm = 1e-6 * abs(given.errors.scale_ppm) * 0.5 * given.longest_mm
    if not scale_mm > MOST_SCALE_SHARE * given.errors.length_error_mm.rms:
        return None
    return Finding(
        Belief.PARTLY,
        f"lengths are wrong by one factor, {given.errors.scale_ppm:+.0f} ppm",
        "the scale",
        "measure the target's pitch, and calibrate again with the true one",
    )


def _single_points(given: _Lengths) -> Finding | None:
    greatest = given.errors.length_error_mm.max
    usual = float(np.percentile(np.abs(given.errors.error), _ALMOST_ALL))
    if greatest <= MOST_BEYOND * usual:
        return None
    return Finding(
        Belief.PARTLY,
        f"single points are far off: 99% of the lengths are within {millimetres(usual)}, but not all",
        "single points",
        "find them in the map of errors, and look at their dots in the pictures",
    )


def _not_known_from(given: _Lengths) -> Finding | None:
    return unknown_origin(given.errors.views_calibrated_on)


def _sound(given: _Lengths) -> Finding:
    views = counted(len(given.errors.views_scored), "view")
    return Finding(
        Belief.YES,
        f"{views} that the calibration has not seen",
        "noise, lens and print together, which lengths alone do not tell apart",
        "measure (a rendered shoot would tell noise from model)",
    )


_LEAVES_OUT = (
    "errors that keep all lengths: a shift or a turn of the whole target",
    "the target's own error: where the print is 0.1% too large, lengths come out 0.1% too small",
    "lengths across larger distances than those on the target",
)

_RULES = Rules[_Lengths](
    doubts=(_not_one_ok, _circular, _few, _scale, _single_points, _not_known_from), sound=_sound
)
