"""Seconds of each method: ``timings.csv``, and their table for people; they are in no other result."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from rich.table import Table

from labcal.bench.distortion.case import Case
from labcal.bench.distortion.checks import HYBRID
from labcal.bench.distortion.figures import CaseFigures, MethodFigures
from labcal.run.tables import read_table, table_text

HEADER = (
    *("method", "family", "strength", "noise_px", "points", "layout", "source", "fault", "seed"),
    *("fit_seconds", "shared_seconds", "predict_seconds_per_1000", "seconds"),
)
"""The columns of ``timings.csv``; `seconds` are those of the case, all its methods together."""

_SHARED = "shared: the fit of hybrid, of which bundle takes the cameras. Alone, bundle is faster."


def timings_table(cases: Sequence[Case], figures: Sequence[CaseFigures], seconds: Sequence[float]) -> str:
    """Return the text of ``timings.csv``: a line for each case and method; what is missing is nan."""
    lines = []
    for case, found, whole in zip(cases, figures, seconds, strict=True):
        cell = case.cell
        place = (cell.family, cell.strength, cell.noise_px, cell.points, str(cell.layout), str(cell.source))
        by_method = {one.method: one for one in found.methods}
        for method in case.methods:
            own = by_method.get(method) or MethodFigures(method=method)
            lines.append(
                (
                    method,
                    *place,
                    cell.fault,
                    case.seed,
                    own.fit_seconds,
                    own.shared_seconds,
                    predict_seconds_per_1000(own),
                    whole,
                )
            )
    return table_text(HEADER, lines)


def predict_seconds_per_1000(figures: MethodFigures) -> float:
    """Return the seconds that 1000 points take with their covariances, over all regions; NaN of none."""
    points = sum(one.n for one in figures.regions)
    return 1000.0 * sum(one.predict_seconds for one in figures.regions) / points if points else float("nan")


def seconds_table(timings: Path) -> Table:
    """Return the median seconds of each method over all cases of a ``timings.csv``, for people.

    The fit of `hybrid` that is made for all counts with every method that takes from it.
    """
    table = Table(title="Seconds by method, median over the cases")
    table.add_column("method", overflow="fold")
    for column in ("fit", "of these, shared", "predict 1000 points"):
        table.add_column(column, justify="right")
    by_method: dict[str, list[list[float]]] = {}
    for line in read_table(HEADER, "timings", timings):
        by_method.setdefault(line[0], []).append([float(text) for text in line[9:12]])
    for method, seconds in by_method.items():
        fit, shared, predict = np.array(seconds).T
        table.add_row(method, _median(fit + shared), _median(shared), _median(predict))
    if any(np.array(seconds)[:, 1].any() for method, seconds in by_method.items() if method != HYBRID):
        table.caption = _SHARED
    return table


def _median(seconds: np.ndarray) -> str:
    known = seconds[np.isfinite(seconds)]
    return f"{np.median(known):.3f}" if len(known) else "-"
