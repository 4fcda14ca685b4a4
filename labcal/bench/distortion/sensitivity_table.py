"""The sensitivity to faults as a table for people."""

from collections.abc import Sequence

import numpy as np
from rich.table import Table

from labcal.bench.distortion.sensitivity import Sensitivity

_MOST_METHODS = 5


def sensitivity_table(found: Sequence[Sensitivity]) -> Table:
    """Return the error with each fault over that without it, by method: medians over the cells."""
    methods = list(dict.fromkeys(one.method for one in found))
    shown = methods[:_MOST_METHODS]
    table = Table(title="RMS error with a fault over that without it")
    table.add_column("fault")
    for method in shown:
        table.add_column(method, justify="right", overflow="fold")
    for fault in dict.fromkeys(one.label for one in found):
        cells = [[one for one in found if (one.label, one.method) == (fault, method)] for method in shown]
        table.add_row(fault, *map(_cell, cells))
    more = len(methods) - len(shown)
    rest = f" results.json has {more} more methods." if more else ""
    table.caption = f"*: noticed by the flag model-misfit or refused. -: measured with pictures alone.{rest}"
    return table


def _cell(cells: Sequence[Sensitivity]) -> str:
    """Return the median over the cells, with a star where the fault is noticed in all of them."""
    mark = "*" if cells and all(one.is_noticed for one in cells) else " "
    known = [one.over_usual for one in cells if np.isfinite(one.over_usual)]
    if known:
        return f"{np.median(known):.3g}{mark}"
    return f"refused{mark}" if any(one.refused for one in cells) else "- "
