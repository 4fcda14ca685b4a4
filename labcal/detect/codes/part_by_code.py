"""A part of a board whose dots are all alike, placed on it by the tags of the print's code."""

from dataclasses import replace

import numpy as np
from jaxtyping import Int

from labcal.arrays import Pixels
from labcal.detect.codes.reading import searched_picture
from labcal.detect.codes.tag_pairs import CodeBlock, find_blocks
from labcal.detect.dots import PictureDots
from labcal.detect.grey import AnyPicture
from labcal.errors import InputError
from labcal.targets.code_places import NUMBERS
from labcal.targets.code_text import PrintedTarget, code_text, text_number
from labcal.targets.sheet import CodePlace, lay_out_with_code

_NEAREST = 12
"""Dots nearest to the code that tell: the tags tell places farther away less well."""
_LARGEST_RESIDUAL = 0.3
"""Usual distance of these dots from where the tags have them, in steps of the board, at most."""
_DECISIVE = 1 / 3
"""Of what the next best place leaves: less is proof."""


def placed_by_code(image: AnyPicture, dots: PictureDots, printed: PrintedTarget) -> PictureDots:
    """Return a picture that shows a part of a board with the ids that the tags of its print tell.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
    dots : PictureDots
        As detected; with a part where the picture is refused because it shows one.
    printed : PrintedTarget

    Returns
    -------
    PictureDots
        `dots` itself where no part or no code of the print is seen, or more than one, and where the dots
        nearest to the code are not within 0.3 steps of a place on the board, and three times farther from
        every other one.
    """
    if dots.refusal is None or dots.part is None:
        return dots
    try:
        number = text_number(code_text(printed.target, printed.copy), NUMBERS)
    except InputError:  # of a target that no code describes
        return dots
    place = lay_out_with_code(printed.target, printed.copy).code
    searched = searched_picture(image)
    if searched is None or place is None:
        return dots
    own = [block for block in find_blocks(searched) if block.is_whole and block.number == number]
    if len(own) != 1 or not dots.part.ok.any():
        return dots
    found = _numbering(dots.part, own[0], place, printed)
    if found is None:
        return dots
    numbered = dots.part if found == 0 else dots.part.renumbered(found - 1)
    return replace(numbered, others=printed.target.symmetric_indices(numbered.index))


def _numbering(part: PictureDots, block: CodeBlock, place: CodePlace, printed: PrintedTarget) -> int | None:
    """Return the number of the numbering that the tags tell, 0 for the part's own; None if none is sure."""
    ok = np.flatnonzero(part.ok)
    away = np.linalg.norm(part.position[ok] - block.places(np.zeros((1, 2))), axis=1)
    near = ok[np.argsort(away, kind="stable")[:_NEAREST]]
    residuals = np.array(
        [
            _residual(part.position[near], index[near], block, place, printed)
            for index in (part.index, *part.others)
        ]
    )
    best = int(residuals.argmin())
    others = np.delete(residuals, best)
    certain = residuals[best] < _LARGEST_RESIDUAL and (residuals[best] < _DECISIVE * others).all()
    return best if certain else None


def _residual(
    q: Pixels, index: Int[np.ndarray, "n 2"], block: CodeBlock, place: CodePlace, printed: PrintedTarget
) -> float:
    """Return the median distance of dots from where the tags have them, in steps; infinite behind it."""
    points = printed.target.points(index)[:, :2]
    step = np.linalg.norm(printed.target.points(np.array([[0, 0], [1, 0]]))[1, :2])

    def seen(at: np.ndarray) -> Pixels:
        return block.places((at - [place.left, place.top]) * [1.0, -1.0] / place.unit)

    there = seen(points)
    steps = np.linalg.norm(seen(points + np.array([step, 0.0])) - there, axis=1)
    off = np.linalg.norm(there - q, axis=1) / np.maximum(steps, 1e-9)
    return float(np.median(off)) if np.isfinite(off).all() else float("inf")
