"""``{paper-rows}``, ``{paper-claims}``, ``{paper-readings}``: a committed result of ``labcal reproduce``.

The argument is the file, relative to the page. Its hash stands below each table, so that a table cannot be
told from its file.
"""

import hashlib
from collections.abc import Iterator
from pathlib import Path
from typing import ClassVar

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import table

from labcal.report.claims_figure import claim_figure
from labcal.report.claims_words import outcome_words, p_words, ratio_words, statement_words, verdict_words
from labcal.report.figures_text import epochs, millimetres, signed_metres
from labcal.report.reproduction import Reproduction, RowResult
from labcal.run.documents import read_document


class _CommittedResults(SphinxDirective):
    """A part of a result file."""

    required_arguments = 1
    note: ClassVar[str] = ""

    def run(self) -> list[nodes.Node]:
        """Return what the result file says, and its hash."""
        path = Path(self.env.doc2path(self.env.docname)).parent / self.arguments[0]
        self.env.note_dependency(str(path))
        result = read_document(Reproduction, "result file", path)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        name = path.relative_to(self.env.srcdir).as_posix()
        return [
            *self.content_of(result),
            *self.parse_text_to_nodes(f"{self.note}From `docs/{name}`, SHA-256 `{digest}`.\n"),
        ]

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield what is shown."""
        raise NotImplementedError


class PaperRows(_CommittedResults):
    """The rows beside the paper's."""

    note = "Medians over the seeds, with their range. "

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield the table of rows."""
        head = [
            "row",
            "method",
            "mean signed, m",
            "paper, m",
            "epochs",
            "paper",
            "RMS, mm",
            "max, mm",
            "verdict",
        ]
        yield from self.parse_text_to_nodes(table(head, map(_row, result.rows)))


class PaperReadings(_CommittedResults):
    """The readings of "least squares"."""

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield the table of readings."""
        rows = [
            [one.reading, ", ".join(one.rows), f"{one.decades:.2f}", "nearest" if one.nearest else ""]
            for one in result.least_squares
        ]
        head = ["reading", "rows", "mean distance, decades", ""]
        yield from self.parse_text_to_nodes(table(head, rows))


class PaperClaims(_CommittedResults):
    """The claims with verdicts, figures and comparisons."""

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield a section of every claim."""
        for claim in result.claims:
            lines = [
                f"**{claim.claim}: {claim.text}**",
                f"{verdict_words(claim).capitalize()} (p = {p_words(claim.adjusted_p)}).",
                f"Our expectation before the first run: {claim.expected}",
            ]
            yield from self.parse_text_to_nodes("\n\n".join(lines) + "\n")
            yield nodes.raw("", f'<div class="claim-figure">{claim_figure(claim)}</div>', format="html")
            rows = [
                [one.where, statement_words(one), one.pairs, ratio_words(one.ratio, one.interval),
                 p_words(one.p), outcome_words(one)]
                for one in claim.comparisons
            ]  # fmt: skip
            head = ["where", "statement", "pairs", "ratio (95% interval)", "p", "supported"]
            yield from self.parse_text_to_nodes(table(head, rows))
        yield from self.parse_text_to_nodes(f"Plan: SHA-256 `{result.claims_plan_sha256}`.\n")


def _row(row: RowResult) -> list[object]:
    """Return the cells of a row."""
    (low, high), (least, most) = row.mean_signed_range_m, row.rmse_range_mm
    steps = epochs(row.epochs) + (", goal not reached" if row.goal_reached is False else "")
    return [
        row.exp,
        f"{row.solver} {row.network or row.reading}",
        f"{signed_metres(row.mean_signed_m)} ({signed_metres(low)} to {signed_metres(high)})",
        signed_metres(row.paper_abs_m),
        steps,
        epochs(row.paper_epochs),
        f"{millimetres(row.rmse_mm)} ({millimetres(least)} to {millimetres(most)})",
        row.verdict,
    ]


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directives."""
    app.add_directive("paper-rows", PaperRows)
    app.add_directive("paper-readings", PaperReadings)
    app.add_directive("paper-claims", PaperClaims)
    return {"parallel_read_safe": True}
