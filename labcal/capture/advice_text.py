"""The advice of a guided capture as text: faults, the error reached, the next pose, small pictures."""

import textwrap
from collections.abc import Mapping

import numpy as np
from jaxtyping import Int

from labcal.arrays import Pixels
from labcal.capture.advice import Advice
from labcal.capture.guide_settings import FEWEST_STATED

WIDTH = 78
"""Characters of a line."""
_COLUMNS = 28
"""Characters across the picture of a camera; a character is about twice as high as wide."""
_GAP = "   "
_ALONG = 12
"""Points that are marked between two of an outline."""


def advice_text(advice: Advice) -> str:
    """Return the advice for a terminal of 80 characters.

    In the small pictures a dot stands where no dot of the target was found yet, an o where some were, and
    the outline to fill is drawn with #.
    """
    lines = [line for fault in advice.faults for line in _wrapped("! ", fault)]
    lines += _wrapped("", _reached(advice))
    lines += [line for lack in advice.lacks for line in _wrapped("- ", lack)]
    if advice.done:
        return "\n".join([*lines, *_wrapped("", f"{advice.words}.")])
    lines += _wrapped("> ", f"{advice.words}.")
    return "\n".join([*lines, *_pictures(advice)])


def summary(advice: Advice) -> str:
    """Return how far a guided capture came, in a line or two."""
    if advice.done:
        return f"{advice.words}."
    missing = "" if advice.wanted_mm is None else " The error asked for is not reached: take more views."
    return f"{_reached(advice)}{missing}"


def _reached(advice: Advice) -> str:
    views = f"{advice.views} usable view{'' if advice.views == 1 else 's'}"
    if advice.reached_mm is None:
        if 0 < advice.views < FEWEST_STATED:
            return f"{views}; the expected error is stated from {FEWEST_STATED} views on."
        return f"{views}; no calibration yet."
    share = "" if advice.calibration_mm is None else f", {advice.calibration_mm:.3g} mm by the calibration"
    wanted = "" if advice.wanted_mm is None else f"; {advice.wanted_mm:.3g} mm asked for"
    kind = "3-D error" if len(advice.sizes) > 1 else "error across the line of sight"
    shape = "" if advice.shape_mm is None else f"; of shape and size alone {advice.shape_mm:.3g} mm"
    return f"{views}: expected {kind} {advice.reached_mm:.3g} mm{share}{shape}{wanted}."


def _wrapped(mark: str, text: str) -> list[str]:
    return textwrap.wrap(text, WIDTH, initial_indent=mark, subsequent_indent=" " * len(mark))


def _pictures(advice: Advice) -> list[str]:
    """Return small pictures side by side, as many as fit a line."""
    drawn = [
        _picture(name, advice.sizes[name], advice.coverage.get(name), advice.outlines)
        for name in advice.sizes
        if name in advice.outlines
    ]
    most, lines = max(1, WIDTH // (_COLUMNS + 2 + len(_GAP))), list[str]()
    for first in range(0, len(drawn), most):
        some = drawn[first : first + most]
        height = max(len(one) for one in some)
        padded = [[*one, *[" " * (_COLUMNS + 2)] * (height - len(one))] for one in some]
        lines += [_GAP.join(parts).rstrip() for parts in zip(*padded, strict=True)]
    return lines


def _picture(
    name: str,
    size: tuple[int, int],
    cells: Int[np.ndarray, "rows columns"] | None,
    outlines: Mapping[str, Pixels],
) -> list[str]:
    """Return the picture of a camera: its frame, the cells with dots, and the outline to fill."""
    rows = max(4, round(0.5 * _COLUMNS * size[1] / size[0]))
    signs = np.full((rows, _COLUMNS), " ")
    down, across = np.arange(rows) / rows, np.arange(_COLUMNS) / _COLUMNS
    if cells is not None:
        found = cells[(down * len(cells)).astype(int)][:, (across * cells.shape[1]).astype(int)] > 0
        signs[:, ::2] = np.where(found, "o", ".")[:, ::2]
    outline = outlines[name]
    share = np.linspace(0.0, 1.0, _ALONG, endpoint=False)[:, None, None]
    along = (outline + share * (np.roll(outline, -1, axis=0) - outline)).reshape(-1, 2)
    at = np.floor(along / np.array(size) * [_COLUMNS, rows])
    inside = np.isfinite(at).all(axis=1) & (at >= 0).all(axis=1) & (at < [_COLUMNS, rows]).all(axis=1)
    column, row = at[inside].astype(int).T
    signs[row, column] = "#"
    edge = "-" * _COLUMNS
    head = f"+ {name[: _COLUMNS - 4]} {edge}"[: _COLUMNS + 1] + "+"
    return [head, *(f"|{''.join(line)}|" for line in signs), f"+{edge}+"]
