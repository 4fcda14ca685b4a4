"""Section: faults that the methods do not know of."""

from collections.abc import Sequence

import numpy as np

from labcal.bench.distortion.checks import LOW_COVERAGE
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.distortion.sensitivity import Sensitivity
from labcal.bench.distortion.sensitivity_coverage import (
    MARK,
    coverage_cell,
    coverage_words,
    stating_methods,
)
from labcal.bench.distortion.sensitivity_figures import sensitivity_figure
from labcal.bench.distortion.trust_words import ratio_words
from labcal.bench.faults.registry import fault_named
from labcal.report.inline_svg import inline_svg, page_style
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Section
from labcal.report.page.download import table_download
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.table import MISSING, Column, PageTable, Side

_HOW = (
    "A wrong board, a stage that reads wrong, and the mistakes of the rendered laboratory: RMS error with "
    "the fault over that without it, at the same points with the same noise. Filled marks: the fault is "
    "noticed, by the flag model-misfit or by a refusal; open marks: nothing warns of it."
)
_CAPTION = "Median of the cells; *: noticed in all of them"
_COVERAGE_CAPTION = (
    f"Coverage of 95% ellipsoids, median of the cells; {MARK}: below {LOW_COVERAGE:g} in a cell, and neither "
    "a flag nor a refusal warns of it"
)


def sensitivity_section(findings: Findings) -> Section | None:
    """Return the error with each fault over that without it, by family, and the table of all methods.

    Parameters
    ----------
    findings : Findings
    """
    found = findings.result.sensitivity
    charts = []
    for family in dict.fromkeys(one.family for one in found):
        own = [one for one in found if one.family == family]
        if any(np.isfinite(one.over_usual) for one in own):
            name = f"sensitivity-{family}"
            with page_style():
                svg = inline_svg(sensitivity_figure(own, family), name, f"{family}: {_HOW}")
            charts.append(Chart(name, svg, f"{family}, strength {own[0].strength:g}."))
    if not found:
        return None
    beside = [Beside(tuple(charts))] if charts else []
    words = tuple(coverage_words(found))
    said = [Prose(words, Tone.NOTE)] if words else []
    return Section(
        "When something is wrong", [Prose((_HOW,)), *said, *beside, _table(found), *_coverage_tables(found)]
    )


def _table(found: Sequence[Sensitivity]) -> PageTable:
    methods = list(dict.fromkeys(one.method for one in found))
    rows = [
        [
            label,
            _meaning(fault),
            *(
                _cell([one for one in found if (one.label, one.method) == (label, method)])
                for method in methods
            ),
        ]
        for label, fault in {one.label: one.fault for one in found}.items()
    ]
    columns = [Column("fault", Side.LEFT), Column("its number", Side.LEFT), *map(Column, methods)]
    header = tuple(name for name in Sensitivity.model_fields if name != "reasons")
    file = table_download("sensitivity.csv", header, [[getattr(one, key) for one in found] for key in header])
    return PageTable("sensitivity", _CAPTION, columns, rows, file)


def _coverage_tables(found: Sequence[Sensitivity]) -> list[PageTable]:
    """Return the table of coverage; none where no method states a covariance."""
    methods = stating_methods(found)
    if not methods:
        return []
    rows = [
        [
            label,
            *(
                coverage_cell([one for one in found if (one.label, one.method) == (label, method)]) or MISSING
                for method in methods
            ),
        ]
        for label in dict.fromkeys(one.label for one in found)
    ]
    columns = [Column("fault", Side.LEFT), *map(Column, methods)]
    return [PageTable("sensitivity-coverage", _COVERAGE_CAPTION, columns, rows)]


def _meaning(fault: str) -> str:
    kind = fault_named(fault).kind
    return kind.size if kind.has_size else MISSING


def _cell(cells: Sequence[Sensitivity]) -> str:
    star = "*" if cells and all(one.is_noticed for one in cells) else ""
    known = [one.over_usual for one in cells if np.isfinite(one.over_usual)]
    if known:
        return f"{ratio_words(float(np.median(known)))}{star}"
    return "refused" if any(one.refused for one in cells) else MISSING
