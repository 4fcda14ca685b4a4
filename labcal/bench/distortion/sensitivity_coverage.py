"""Coverage of 95% ellipsoids with faults: a table for people, and words on those that nothing warns of."""

from collections.abc import Sequence

import numpy as np
from rich.table import Table

from labcal.bench.distortion.checks import LOW_COVERAGE
from labcal.bench.distortion.sensitivity import Sensitivity
from labcal.wording import listed

MARK = "!"
"""Beside a coverage: the ellipsoids are too small in a cell, and nothing warns of it."""
_MOST_METHODS = 5
_MOST_FAULTS = 8


def is_overconfident(one: Sensitivity) -> bool:
    """Return whether the ellipsoids with a fault are too small, and neither a flag nor a refusal warns of it.

    A method of which all seeds are flagged with the fault warns, also where it is flagged without it, too.
    """
    warned = one.is_noticed or (one.seeds > 0 and one.misfit == one.seeds)
    return one.coverage95 < LOW_COVERAGE and not warned


def coverage_cell(cells: Sequence[Sensitivity]) -> str | None:
    """Return the median coverage of one method with one fault, with a mark; None where none is stated.

    Parameters
    ----------
    cells : sequence of Sensitivity
        Of one method and fault, a cell of the plan each.
    """
    known = [one.coverage95 for one in cells if np.isfinite(one.coverage95)]
    if not known:
        return None
    return f"{np.median(known):.3f}" + (MARK if any(map(is_overconfident, cells)) else "")


def stating_methods(found: Sequence[Sensitivity]) -> list[str]:
    """Return the methods that state a covariance with any fault."""
    return list(dict.fromkeys(one.method for one in found if np.isfinite(one.coverage95)))


def coverage_words(found: Sequence[Sensitivity]) -> list[str]:
    """Return a sentence for each method whose ellipsoids a fault makes too small without a warning.

    Where there is no such method, one sentence says that; there is none where no covariance is stated.

    Parameters
    ----------
    found : sequence of Sensitivity
    """
    sentences = []
    for method in dict.fromkeys(one.method for one in found):
        worst: dict[str, Sensitivity] = {}
        for one in (each for each in found if each.method == method and is_overconfident(each)):
            if one.label not in worst or one.coverage95 < worst[one.label].coverage95:
                worst[one.label] = one
        if worst:
            named = [f"{label} ({_figures(one)})" for label, one in worst.items()]
            sentences.append(
                f"The 95% ellipsoids of {method} are too small with these faults, and nothing warns of it: "
                f"{listed(named, _MOST_FAULTS)}."
            )
    if sentences or not stating_methods(found):
        return sentences
    return [f"Where nothing warns of a fault, 95% ellipsoids hold at least {LOW_COVERAGE:.0%} of the errors."]


def _figures(one: Sensitivity) -> str:
    usual = "" if np.isnan(one.usual_coverage95) else f", {one.usual_coverage95:.3f} without it"
    return f"coverage {one.coverage95:.3f}{usual}"


def coverage_tables(found: Sequence[Sensitivity]) -> list[Table]:
    """Return a table of the coverage with each fault by method, medians over the cells.

    There is none where no covariance is stated.

    Parameters
    ----------
    found : sequence of Sensitivity
    """
    methods = stating_methods(found)[:_MOST_METHODS]
    if not methods:
        return []
    table = Table(title="Coverage of 95% ellipsoids with a fault")
    table.add_column("fault")
    for method in methods:
        table.add_column(method, justify="right", overflow="fold")
    for fault in dict.fromkeys(one.label for one in found):
        cells = [[one for one in found if (one.label, one.method) == (fault, method)] for method in methods]
        table.add_row(fault, *((coverage_cell(own) or "-").ljust(6) for own in cells))
    table.caption = f"{MARK}: below {LOW_COVERAGE:g} in a cell, and neither a flag nor a refusal warns of it."
    return [table]
