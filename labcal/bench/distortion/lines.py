"""Tidy lines of results: one for each case, method and region."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from itertools import chain

from labcal.bench.distortion.case import Case, Cell
from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.families.registry import FAMILIES
from labcal.run.tables import table_text

HEADER = (
    *("method", "family", "strength", "known_as", "noise_px", "points", "layout", "source", "fault"),
    *("measured", "seed"),
    *("trained", "beyond_pinhole_px", "pixel_error_px"),
    *("n", "predicted", "rmse_mm", "oracle_mm", "over_oracle"),
    *("stated", "covered", "coverage95", "model_misfit", "extrapolated", "expected_mm", "reason"),
)
"""The columns of ``results.csv``."""


@dataclass(frozen=True)
class Line:
    """One method in one region of one case.

    Attributes
    ----------
    figures : RegionFigures, optional
        None where there are none; then there is a reason.
    """

    method: str
    cell: Cell
    seed: int
    measured: str
    figures: RegionFigures | None
    trained: int = 0
    beyond_pinhole_px: float = float("nan")
    misfit: bool | None = None
    expected_mm: float = float("nan")
    reason: str | None = None
    pixel_error_px: float = float("nan")

    @property
    def over_oracle(self) -> float:
        """RMS error over the oracle's; NaN without figures."""
        return float("nan") if self.figures is None else self.figures.over_oracle


def lines_of(cases: Iterable[Case], figures: Iterable[CaseFigures]) -> list[Line]:
    """Return a line for each case, method and region, in the order of the cases."""
    return [line for case, found in zip(cases, figures, strict=True) for line in _lines(case, found)]


def _lines(case: Case, found: CaseFigures) -> Iterator[Line]:
    if found.reason is not None:
        for method in case.methods:
            for region in case.regions:
                yield Line(method, case.cell, case.seed, str(region), None, reason=found.reason)
        return
    for one in found.methods:
        yield from _of_method(case, found, one)


def _of_method(case: Case, found: CaseFigures, one: MethodFigures) -> Iterator[Line]:
    regions = {figures.measured: figures for figures in one.regions}
    for region in case.regions:
        figures = regions.get(str(region))
        reason = one.reason
        if figures is not None and not figures.predicted:
            reason = "the method gives no place for any point"
        yield Line(
            one.method,
            case.cell,
            case.seed,
            str(region),
            figures,
            found.trained,
            found.beyond_pinhole_px,
            one.misfit,
            one.expected_mm,
            reason,
            found.pixel_error_px,
        )


def results_table(lines: Sequence[Line], further: Iterable[Sequence[object]] = ()) -> str:
    """Return the text of ``results.csv``; what is missing is nan, flags are 0 and 1.

    Further lines, which are not of a cell, come last.
    """
    return table_text(HEADER, chain(map(line_cells, lines), further))


def line_cells(line: Line) -> list[object]:
    """Return the cells of a line, in the order of the columns.

    Raises
    ------
    KeyError
        There is no such family.
    """
    cell, one, nan = line.cell, line.figures, float("nan")
    factors: list[object] = [line.method, cell.family, cell.strength]
    factors += [FAMILIES[cell.family].known_as(cell.strength), cell.stated_noise_px, cell.points]
    factors += [
        str(cell.layout),
        str(cell.source),
        cell.fault,
        line.measured,
        line.seed,
        line.trained,
        line.beyond_pinhole_px,
        line.pixel_error_px,
    ]
    figures: list[object] = [0, 0, nan, nan, nan, 0, 0, nan]
    if one is not None:
        figures = [one.n, one.predicted, one.rmse_mm, one.oracle_mm, one.over_oracle]
        figures += [one.stated, one.covered, one.coverage95]
    misfit = "" if line.misfit is None else int(line.misfit)
    rest = [misfit, 0 if one is None else one.extrapolated, line.expected_mm, line.reason or ""]
    return [*factors, *figures, *rest]
