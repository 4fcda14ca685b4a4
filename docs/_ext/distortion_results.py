"""A committed result of ``labcal bench distortion``, a directive for each of its parts.

They are ``distortion-answer``, ``distortion-trust``, ``distortion-errors``, ``distortion-winners``,
``distortion-checks`` and ``distortion-plan``. Those of errors and winners have a
second argument, the region.
"""

from collections.abc import Iterator

from committed_results import CommittedResults, listed
from docutils import nodes
from sphinx.application import Sphinx
from tables import table

from labcal.bench.distortion.case import Measured
from labcal.bench.distortion.enough_points import least_of
from labcal.bench.distortion.family_figure import family_figure
from labcal.bench.distortion.page.family_table import family_rows
from labcal.bench.distortion.page.plan_rows import plan_rows, setting_words
from labcal.bench.distortion.page.winner_table import WINNER_COLUMNS, winner_cells
from labcal.bench.distortion.result import DistortionResult
from labcal.bench.distortion.trust_words import trust_entries
from labcal.bench.distortion.winner_groups import winner_groups


class _DistortionResults(CommittedResults[DistortionResult]):
    """A part of a result file of ``labcal bench distortion``."""

    model = DistortionResult
    command = "labcal bench distortion"


class _OfRegion(_DistortionResults):
    """A part of one region."""

    required_arguments = 2

    @property
    def region(self) -> Measured:
        """The region, ``within`` or ``outside``."""
        return Measured(self.arguments[1])


class DistortionAnswer(_DistortionResults):
    """The answer to "should I use a network?"."""

    def content_of(self, result: DistortionResult) -> Iterator[nodes.Node]:
        """Yield its sentences."""
        for sentence in result.answer:
            yield from self.parse_text_to_nodes(f"**{sentence}**\n")
        for method, given in result.plan.settings.items():
            yield from self.parse_text_to_nodes(f"`{method}` was measured with {setting_words(given)}.\n")


class DistortionTrust(_DistortionResults):
    """How far each method can be trusted, in words."""

    def content_of(self, result: DistortionResult) -> Iterator[nodes.Node]:
        """Yield an entry for each method."""
        yield from self.parse_text_to_nodes(
            listed(f"`{name}`. {words}" for name, words in trust_entries(result))
        )
        points = least_of(result.plan.points)
        yield from self.parse_text_to_nodes(
            f"Of cells with {points} training points or more, over all noises and layouts.\n"
        )


class DistortionErrors(_OfRegion):
    """Errors over the strength: the figure and the table."""

    def content_of(self, result: DistortionResult) -> Iterator[nodes.Node]:
        """Yield the figure of all families, and their figures."""
        figures = result.families if self.region is Measured.WITHIN else result.outside
        svg = family_figure(figures, f"family-{self.region}")
        yield nodes.raw("", f'<div class="claim-figure">{svg}</div>', format="html")
        head = ["family, method", *(f"{strength:g}" for strength in result.plan.strengths)]
        yield from self.parse_text_to_nodes(table(head, family_rows(figures, result.plan.strengths)))


class DistortionWinners(_OfRegion):
    """The best methods by family and strength."""

    def content_of(self, result: DistortionResult) -> Iterator[nodes.Node]:
        """Yield the table."""
        head = [column.heading for column in WINNER_COLUMNS]
        rows = map(winner_cells, winner_groups(result.winners, self.region))
        yield from self.parse_text_to_nodes(table(head, rows))


class DistortionChecks(_DistortionResults):
    """The checks with their limits."""

    def content_of(self, result: DistortionResult) -> Iterator[nodes.Node]:
        """Yield the table of checks, and which cells miss one."""
        rows = [
            [one.name, f"{one.value:.4g}", f"{one.limit:g}", "kept" if one.ok else "missed"]
            for one in result.checks
        ]
        yield from self.parse_text_to_nodes(table(["check", "value", "limit", ""], rows))
        yield from self.parse_text_to_nodes(listed(result.notes))


class DistortionPlan(_DistortionResults):
    """The plan with its hash."""

    def content_of(self, result: DistortionResult) -> Iterator[nodes.Node]:
        """Yield the levels of every factor."""
        yield from self.parse_text_to_nodes(table(["factor", "levels"], plan_rows(result)))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directives."""
    app.add_directive("distortion-answer", DistortionAnswer)
    app.add_directive("distortion-trust", DistortionTrust)
    app.add_directive("distortion-errors", DistortionErrors)
    app.add_directive("distortion-winners", DistortionWinners)
    app.add_directive("distortion-checks", DistortionChecks)
    app.add_directive("distortion-plan", DistortionPlan)
    return {"parallel_read_safe": True}
