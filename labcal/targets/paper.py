"""Sizes of paper by name, and the smallest one on which a sheet can be printed."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from labcal.errors import InputError, UnknownNameError
from labcal.targets.catalogue import AnyTarget
from labcal.targets.sheet import lay_out_print

PRINTER_MARGIN_MM = 5.0
"""Rim that most printers leave bare."""
SHEET_BORDER_MM = 10.0
"""Rim of a laid out sheet on which nothing is printed, as wide as that of :func:`lay_out_print`."""
_LEAST_MM, _MOST_MM = 20.0, 5000.0


@dataclass(frozen=True)
class Paper:
    """A sheet of paper, upright: the shorter side is the width.

    Parameters
    ----------
    name : str
        Its usual name, or ``WxH`` in mm.
    width_mm, height_mm : float
    """

    name: str
    width_mm: float
    height_mm: float

    def holds(self, width_mm: float, height_mm: float) -> bool:
        """Tell whether a rectangle fits in one of both orientations; a hundredth of a mm does not count."""
        sides = sorted((width_mm, height_mm))
        return sides[0] <= self.width_mm + 0.01 and sides[1] <= self.height_mm + 0.01

    @property
    def sides(self) -> str:
        """Name and sides in words."""
        return f"{self.name} ({self.width_mm:g} mm x {self.height_mm:g} mm)"


PAPERS: Mapping[str, Paper] = {
    paper.name: paper
    for paper in (
        Paper("a5", 148.0, 210.0),
        Paper("letter", 215.9, 279.4),
        Paper("a4", 210.0, 297.0),
        Paper("a3", 297.0, 420.0),
        Paper("a2", 420.0, 594.0),
        Paper("a1", 594.0, 841.0),
        Paper("a0", 841.0, 1189.0),
    )
}
"""Papers by name, in the order of their area."""


def paper_of(text: str) -> Paper:
    """Return the paper of a name, or of sides in mm as ``300x200``.

    Raises
    ------
    UnknownNameError
        There is no paper of that name.
    InputError
        The sides are no lengths of a sheet.
    """
    found = re.fullmatch(r"(\d+(?:\.\d+)?)x(\d+(?:\.\d+)?)(?:mm)?", text.strip().lower())
    if found is None:
        name = text.strip().lower()
        if name not in PAPERS:
            raise UnknownNameError("paper (or sides in mm, as 300x200)", text, PAPERS)
        return PAPERS[name]
    sides = sorted(float(side) for side in found.groups())
    if not _LEAST_MM <= sides[0] <= sides[1] <= _MOST_MM:
        raise InputError(
            f"The sides of a paper should be {_LEAST_MM:g} to {_MOST_MM:g} mm, but are {text}. "
            "Give them in mm, as 300x200."
        )
    return Paper(f"{sides[0]:g}x{sides[1]:g}", *sides)


def sheet_size(target: AnyTarget, copy: int | None = 0) -> tuple[float, float]:
    """Return width and height of the sheet of a target, with ruler, captions, code and border, mm.

    Parameters
    ----------
    target : AnyTarget
    copy : int or None
        Number of the print; None for a plain one, without a code.
    """
    paper = lay_out_print(target, copy).paper
    return paper.width, paper.height


def smallest_paper(target: AnyTarget, copy: int | None = 0) -> Paper | None:
    """Return the smallest usual paper that holds the sheet of a target; None where none does."""
    size = sheet_size(target, copy)
    return next((paper for paper in PAPERS.values() if paper.holds(*size)), None)
