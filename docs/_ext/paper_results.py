"""A committed result of ``labcal reproduce``, a directive for each of its parts.

They are ``paper-rows``, ``paper-readings``, ``paper-claims``, ``paper-study`` and ``paper-explanations``.
"""

from collections.abc import Iterator

from committed_results import CommittedResults, listed
from docutils import nodes
from sphinx.application import Sphinx
from tables import table

from labcal.report.claims_figure import claim_figure
from labcal.report.claims_words import outcome_words, p_words, ratio_words, statement_words, verdict_words
from labcal.report.explanations_words import (
    cause_sentences,
    divisor_sentences,
    given_rows,
    greatest_words,
    length_words,
    quotient_words,
    rows_words,
    size_words,
    summary_sentences,
)
from labcal.report.figure_readings import FigureReading
from labcal.report.figures_text import epochs, goal, millimetres, signed_metres
from labcal.report.reproduction import Reproduction, RowResult
from labcal.report.study_figure import study_figure
from labcal.report.study_words import goal_words, of_each_data, range_words, study_sentences


class _PaperResults(CommittedResults[Reproduction]):
    """A part of a result file of ``labcal reproduce``."""

    model = Reproduction
    command = "labcal reproduce"


class PaperRows(_PaperResults):
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


class PaperReadings(_PaperResults):
    """The readings of "least squares"."""

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield the table of readings."""
        rows = [
            [one.reading, ", ".join(one.rows), f"{one.decades:.2f}", "nearest" if one.nearest else ""]
            for one in result.least_squares
        ]
        head = ["reading", "rows", "mean distance, decades", ""]
        yield from self.parse_text_to_nodes(table(head, rows))


class PaperClaims(_PaperResults):
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


class PaperStudy(_PaperResults):
    """The study of neurons and layers: the best networks in words, the figure, every network."""

    note = "Medians over the seeds, with their range; of points that were not trained on. "

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield the sentences, the figure and a table of every kind of data."""
        yield from self.parse_text_to_nodes(listed(study_sentences(result.study)))
        yield nodes.raw("", f'<div class="claim-figure">{study_figure(result.study)}</div>', format="html")
        for data, cells in of_each_data(result.study).items():
            yield from self.parse_text_to_nodes(
                f"**{data}**, {cells[0].points} points, goal {goal(cells[0].goal)}\n"
            )
            head = ["network", "weights", "RMS, mm", "epochs", "goal reached", "seconds"]
            rows = [
                [
                    cell.network,
                    cell.parameters,
                    range_words(*map(millimetres, (cell.rmse_mm, *cell.rmse_range_mm))),
                    range_words(*map(epochs, (cell.epochs, *cell.epochs_range))),
                    goal_words(cell),
                    f"{cell.seconds:.2g}",
                ]
                for cell in cells
            ]
            yield from self.parse_text_to_nodes(table(head, rows))


class PaperExplanations(_PaperResults):
    """The mistakes that would give rows 17 to 23, with their sizes, and the divisors."""

    note = "Sizes are medians over the seeds, with their range. "

    def content_of(self, result: Reproduction) -> Iterator[nodes.Node]:
        """Yield a section of every cause, and one of the divisors."""
        found = result.explanations
        if found is None:
            raise self.error(f"{self.arguments[0]} holds no explanations.")
        yield from self.parse_text_to_nodes(listed(summary_sentences(found)))
        for cause in found.causes:
            low, high = cause.likely
            words = f"**{cause.cause}**: {cause.words}; likely {low:g} to {high:g} {cause.unit}.\n"
            yield from self.parse_text_to_nodes(words)
            yield from self.parse_text_to_nodes(listed(cause_sentences(cause)))
            head = ["row", "method", "printed figure read as", "paper, m", "size", "greatest error met, m",
                    "gives also"]  # fmt: skip
            rows = [
                [row.exp, row.method, row.figure, signed_metres(row.paper_m), size_words(row, cause),
                 greatest_words(row), rows_words(row.also_gives)]
                for row in cause.rows
            ]  # fmt: skip
            yield from self.parse_text_to_nodes(table(head, rows))
        yield from self.parse_text_to_nodes("**A unit, or a length that our error was divided by**\n")
        yield from self.parse_text_to_nodes(listed(divisor_sentences(found)))
        divisors = [
            [
                one.divisor,
                length_words(one),
                *(rows_words(given_rows(one, figure)) for figure in FigureReading),
            ]
            for one in found.divisors
        ]
        head = ["divisor", "mm", *(f"rows, as {figure}" for figure in FigureReading)]
        yield from self.parse_text_to_nodes(table(head, divisors))
        quotients = [
            [one.exp, one.figure, signed_metres(one.printed), millimetres(one.ours_mm), quotient_words(one)]
            for one in found.quotients
        ]
        head = ["row", "printed figure read as", "printed", "ours, mm", "needed divisor, mm"]
        yield from self.parse_text_to_nodes(table(head, quotients))


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
    app.add_directive("paper-study", PaperStudy)
    app.add_directive("paper-explanations", PaperExplanations)
    return {"parallel_read_safe": True}
