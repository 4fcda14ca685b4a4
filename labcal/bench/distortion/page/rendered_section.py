"""Section: through rendered pictures."""

from collections.abc import Sequence

import numpy as np

from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.checks import LOW_COVERAGE
from labcal.bench.distortion.curves import error_figure
from labcal.bench.distortion.page.cell_table import cell_download
from labcal.bench.distortion.page.family_charts import strength_words
from labcal.bench.distortion.page.family_table import family_table
from labcal.bench.distortion.page.findings import Findings
from labcal.report.inline_svg import inline_svg, page_style
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Section
from labcal.report.page.prose import Prose
from labcal.wording import listed

_HOW = (
    "The same cameras take rendered pictures of a board on a stage, and labcal's detector measures its dots. "
    "The oracle triangulates the same detected dots with the true cameras: what the detector errs by is in "
    "both. Open marks are flagged model-misfit. Answer, winners and checks are without these figures."
)


def rendered_section(findings: Findings) -> Section | None:
    """Return the errors over the strength through pictures, by family.

    Parameters
    ----------
    findings : Findings
    """
    pictured = [one for one in findings.summaries if one.cell.is_pictured]
    charts = []
    for family in dict.fromkeys(one.cell.family for one in pictured):
        own = [one for one in pictured if one.cell.family == family and one.over_oracle > 0.0]
        if own:
            name = f"rendered-{family}"
            with page_style():
                svg = inline_svg(error_figure(own, family), name, f"{family}: errors through pictures")
            charts.append(
                Chart(
                    name,
                    svg,
                    f"{family}, rendered: {strength_words(family, own)}.",
                    cell_download(f"{name}.csv", own),
                )
            )
    rendered = findings.result.rendered
    if not rendered:
        return None
    beside = [Beside(tuple(charts))] if charts else []
    strengths = sorted({one.strength for one in rendered})
    table = family_table("families-rendered", rendered, strengths)
    words = coverage_words(pictured)
    return Section("Through rendered pictures", [Prose((_HOW, *words)), *beside, table])


def coverage_words(pictured: Sequence[CellSummary]) -> tuple[str, ...]:
    """Return a sentence on ellipsoids that are too small without a flag; none where no covariance is stated.

    Parameters
    ----------
    pictured : sequence of CellSummary
        Of pictures in which nothing is wrong.
    """
    known = [one for one in pictured if np.isfinite(one.unflagged_coverage95)]
    wrong = [one for one in known if one.unflagged_coverage95 < LOW_COVERAGE]
    if wrong:
        cells = [
            f"{one.method}, {one.cell.family} {one.cell.strength:g} ({one.unflagged_coverage95:.3f})"
            for one in sorted(wrong, key=lambda one: one.unflagged_coverage95)
        ]
        share = f"Coverage of 95% ellipsoids below {LOW_COVERAGE:g}"
        return (f"{share}, where the flag model-misfit is not raised: {listed(cells)}.",)
    if known:
        return (f"95% ellipsoids hold at least {LOW_COVERAGE:.0%} of the errors wherever no flag is raised.",)
    return ()
