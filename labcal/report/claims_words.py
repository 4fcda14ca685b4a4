"""Words about tested claims, for the terminal and the page."""

import math

from labcal.report.claims import ClaimResult, ComparisonResult
from labcal.report.figures_text import MISSING
from labcal.report.values import Measured


def verdict_words(claim: ClaimResult) -> str:
    """Return the verdict, with the conditions under which a claim holds."""
    return f"{claim.verdict}: {'; '.join(claim.where)}" if claim.where else claim.verdict


def statement_words(comparison: ComparisonResult) -> str:
    """Return the statement about the ratio."""
    sign = {"at most": "<", "more than": ">"}.get(comparison.statement)
    factor = f"{comparison.factor:g}"
    return f"ratio {sign} {factor}" if sign else f"ratio within 1/{factor} to {factor}"


def ratio_words(ratio: Measured, interval: tuple[Measured, Measured]) -> str:
    """Return a ratio with its interval: ``2.1 (1.8 to 2.4)``."""
    low, high = interval
    if math.isnan(low) or math.isnan(high):
        return f"{three_digits(ratio)} (no interval)"
    return f"{three_digits(ratio)} ({three_digits(low)} to {three_digits(high)})"


def three_digits(value: float) -> str:
    """Return a positive number with three significant digits, and a power of ten where it is long."""
    if math.isnan(value):
        return MISSING
    return f"{value:.3g}".replace("e-0", "e-").replace("e+0", "e")


def p_words(p: float) -> str:
    """Return a p value with two significant digits."""
    return f"{p:.2g}" if p >= 1e-4 else f"{p:.0e}".replace("e-0", "e-")  # noqa: PLR2004 -- 0.0001 is still short


def outcome_words(comparison: ComparisonResult) -> str:
    """Return the outcome of one comparison."""
    if comparison.supported is None:
        return "undecided"
    return "yes" if comparison.supported else "no"
