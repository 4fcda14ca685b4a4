"""Table of the best methods by family and strength."""

from collections.abc import Sequence

from labcal.bench.distortion.trust_words import ratio_words
from labcal.bench.distortion.winner_groups import WinnerGroup, winner_groups
from labcal.bench.distortion.winners import Winner
from labcal.report.page.download import Download, table_download
from labcal.report.page.table import MISSING, Column, PageTable, Side

WINNER_COLUMNS = (
    Column("family, strength", Side.LEFT),
    Column("known as", Side.LEFT),
    Column("best in cells", Side.WIDE),
    Column("error over the oracle's"),
    Column("second over best"),
    Column("clearly", meaning="The second errs by more than 5% more, and every seed agrees."),
)
WINNER_WORDS = (
    "Over all noises, numbers of points and layouts. Best in cells: how many cells each method wins. Error: "
    "of the best method, over the oracle's. Second over best: the second method's error over the best one's, "
    "seed by seed. Both are medians of the cells, with their range. Clearly: cells in which the second errs "
    "by more than 5% more, and every seed agrees. Where none is clear, the two are as good as each other."
)
_CAPTION = "The best methods by family and strength"


def winner_table(name: str, winners: Sequence[Winner], region: str) -> PageTable:
    """Return the table of a region, with every cell's winner as a file.

    Parameters
    ----------
    name : str
        Its id in the page, and the name of the file.
    winners : sequence of Winner
    region : str
    """
    rows = list(map(winner_cells, winner_groups(winners, region)))
    return PageTable(name, _CAPTION, WINNER_COLUMNS, rows, _file(name, winners, region))


def winner_cells(group: WinnerGroup) -> list[str]:
    """Return the cells of a row, for the page and for the documentation."""
    won = ", ".join(f"{method} {number}" for method, number in group.won.items())
    return [
        f"{group.family} {group.strength:g}",
        group.known_as,
        won or MISSING,
        _range(group.over_oracle),
        _range(group.lead),
        f"{group.clear} of {group.cells}",
    ]


def _range(values: tuple[float, float, float]) -> str:
    middle, low, high = map(ratio_words, values)
    if "nan" in middle:
        return MISSING
    return middle if low == high else f"{middle} ({low} to {high})"


def _file(name: str, winners: Sequence[Winner], region: str) -> Download:
    own, header = [one for one in winners if one.measured == region], tuple(Winner.model_fields)
    return table_download(f"{name}.csv", header, [[getattr(one, key) for one in own] for key in header])
