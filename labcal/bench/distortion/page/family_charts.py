"""Charts of the page: a figure for each family and layout, with its numbers."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from matplotlib.figure import Figure

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.page.cell_table import cell_download
from labcal.bench.distortion.page.findings import Findings
from labcal.bench.families.registry import FAMILIES
from labcal.report.inline_svg import inline_svg, page_style
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart

Draw = Callable[[Sequence[CellSummary], str], Figure]


@dataclass(frozen=True)
class ChartKind:
    """A kind of chart.

    Attributes
    ----------
    name : str
        Begins the names of its charts and files.
    region : Measured
    draw : callable
        From cells and a title to a figure.
    shows : str
        What is drawn, for those who cannot see it.
    chosen : callable
        From a cell to whether it is drawn.
    """

    name: str
    region: Measured
    draw: Draw
    shows: str
    chosen: Callable[[CellSummary], bool]


def family_charts(findings: Findings, kind: ChartKind) -> list[Beside]:
    """Return charts of a kind, beside each other; none where no cell has a figure.

    Parameters
    ----------
    findings : Findings
    kind : ChartKind
    """
    charts = []
    layouts = findings.result.plan.layout
    for family in findings.families:
        for layout in layouts:
            cells = [one for one in findings.cells(family, layout, kind.region) if kind.chosen(one)]
            if not cells:
                continue
            title = family if len(layouts) == 1 else f"{family}, {layout}"
            name = f"{kind.name}-{family}" if len(layouts) == 1 else f"{kind.name}-{family}-{layout}"
            with page_style():
                svg = inline_svg(kind.draw(cells, title), name, f"{title}: {kind.shows}")
            caption = f"{title}: {strength_words(family, cells)}."
            charts.append(Chart(name, svg, caption, cell_download(f"{name}.csv", cells)))
    return [Beside(tuple(charts))] if charts else []


def strength_words(family: str, cells: Sequence[CellSummary]) -> str:
    """Return what the greatest strength of a figure is, as people know it.

    Parameters
    ----------
    family : str
    cells : sequence of CellSummary
        Of the family.
    """
    greatest = max(one.cell.strength for one in cells)
    return f"strength {greatest:g} is {FAMILIES[family].known_as(greatest)}"
