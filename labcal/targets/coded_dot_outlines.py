"""Outlines of coded dots: the dots, the black sectors of their rings, and numbers for people."""

import numpy as np
from matplotlib.font_manager import FontProperties
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

from labcal.targets.coded_dots import RING_INNER, RING_OUTER, CodedDots
from labcal.targets.ring_codes import code_book

_NUMBER_SIZE = 0.7
"""Height of the printed numbers, in radii of a dot."""
_NUMBER_AT = (-3.9, -3.9)
"""Their lower left end: in a corner, outside the circle that a mark needs."""


def coded_dot_outlines(sheet: CodedDots) -> Outline:
    """Return the outlines of all dots, sectors and numbers as one path, mm.

    Circles and arcs are matplotlib's cubic curves, true to 1e-5 of the radius or better. A mark's number
    stands at its lower left.
    """
    radius = sheet.dot_diameter_mm / 2
    book, parts = code_book(sheet.code), []
    for centre, mark in zip(sheet.points()[:, :2], sheet.marks().tolist(), strict=True):
        marks = [Outline.unit_circle(), *_sectors(book.word(mark)), _number(mark)]
        parts += [Outline(radius * np.asarray(one.vertices) + centre, one.codes) for one in marks]
    return Outline.make_compound_path(*parts)


def _sectors(word: np.ndarray) -> list[Outline]:
    """Return the black parts of a ring, one path for neighbours, in radii of the dot; clockwise from x."""
    step = 360.0 / len(word)
    starts = np.flatnonzero(word & ~np.roll(word, 1))
    parts = []
    for start in starts.tolist():
        length = int(np.argmin(np.roll(word, -start)))
        arc = Outline.arc(-(start + length) * step, -start * step)
        there, codes = np.asarray(arc.vertices), np.asarray(arc.codes)
        vertices = np.concatenate([RING_OUTER * there, RING_INNER * there[::-1], RING_OUTER * there[:1]])
        back = codes[::-1].copy()
        back[-1], back[0] = back[0], Outline.LINETO  # a curve's codes stand at its end in either direction
        parts.append(Outline(vertices, np.concatenate([codes, back, [Outline.CLOSEPOLY]])))
    return parts


def _number(mark: int) -> Outline:
    """Return a mark's number, in radii of the dot."""
    font = FontProperties(family="DejaVu Sans")
    return TextPath(_NUMBER_AT, str(mark), size=_NUMBER_SIZE / 0.73, prop=font)  # type: ignore[no-untyped-call, unused-ignore]
