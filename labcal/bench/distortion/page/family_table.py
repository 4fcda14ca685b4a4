"""Table of errors by family and method over the strength."""

from collections.abc import Sequence

from labcal.bench.distortion.result import FamilyFigures
from labcal.bench.distortion.trust_words import ratio_words
from labcal.report.page.download import table_download
from labcal.report.page.table import MISSING, Column, PageTable, Side

_CAPTION = "Median of the cells, the greatest in brackets; *: flagged model-misfit in all"


def family_table(name: str, figures: Sequence[FamilyFigures], strengths: Sequence[float]) -> PageTable:
    """Return the table of one region, and all its figures as a file.

    Parameters
    ----------
    name : str
        Its id in the page, and the name of the file.
    figures : sequence of FamilyFigures
    strengths : sequence of float
        The columns.
    """
    columns = [Column("family, method", Side.LEFT), *(Column(f"{strength:g}") for strength in strengths)]
    header = tuple(FamilyFigures.model_fields)
    file = table_download(f"{name}.csv", header, [[getattr(one, key) for one in figures] for key in header])
    return PageTable(name, _CAPTION, columns, family_rows(figures, strengths), file)


def family_rows(figures: Sequence[FamilyFigures], strengths: Sequence[float]) -> list[list[str]]:
    """Return a row for each family and method, for the page and for the documentation.

    Parameters
    ----------
    figures : sequence of FamilyFigures
    strengths : sequence of float
    """
    known = {(one.family, one.method, one.strength): one for one in figures}
    return [
        [f"{family}, {method}", *(_cell(known.get((family, method, strength))) for strength in strengths)]
        for family, method in dict.fromkeys((one.family, one.method) for one in figures)
    ]


def _cell(one: FamilyFigures | None) -> str:
    if one is None or not one.over_oracle >= 0.0:
        return MISSING
    star = "*" if one.flagged == one.cells else ""
    middle, worst = ratio_words(one.over_oracle), ratio_words(one.worst)
    return f"{middle}{star}" if middle == worst else f"{middle}{star} ({worst})"
