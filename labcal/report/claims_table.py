"""The tested claims in a terminal."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Column, Table
from rich.text import Text

from labcal.report.claims import ClaimResult
from labcal.report.claims_words import (
    outcome_words,
    p_words,
    ratio_words,
    statement_words,
    verdict_words,
)

_STYLES = {"holds": "green", "does not hold": "red", "holds only where": "yellow"}
_NOTE = (
    "Ratios of errors (or of what is named) at the same seed: Hodges-Lehmann estimate, 95% interval. p: "
    "exact Wilcoxon test, after Holm's correction over the claims that were run together."
)


def claims_table(claims: Sequence[ClaimResult]) -> RenderableType:
    """Return every claim with its verdict and its comparisons; the width of a terminal of 80 columns fits."""
    parts: list[RenderableType] = []
    for claim in claims:
        head = Text.assemble((f"{claim.claim}  ", "bold"), claim.text)
        verdict = Text(f"    {verdict_words(claim)} (p = {p_words(claim.adjusted_p)})")
        verdict.stylize(_STYLES.get(claim.verdict, ""))
        table = Table(
            Column("where", overflow="fold"),
            Column("statement", no_wrap=True),
            Column("ratio", overflow="fold"),
            Column("", no_wrap=True),
            box=SIMPLE_HEAD,
            pad_edge=False,
            show_edge=False,
            padding=(0, 1, 0, 0),
        )
        for one in claim.comparisons:
            table.add_row(
                Text(one.where),
                statement_words(one),
                ratio_words(one.ratio, one.interval),
                outcome_words(one),
            )
        parts += [head, verdict, table, Text("")]
    return Group(*parts, Text(_NOTE))
