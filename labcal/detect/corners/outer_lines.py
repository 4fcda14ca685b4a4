"""Outermost lines of a board's corners: whether so much of each is seen that it numbers the others."""

import numpy as np
from jaxtyping import Bool, Int

from labcal.detect.stage_settings.saddle import SaddleSettings


def shows_line(places: Int[np.ndarray, " n"], length: int, settings: SaddleSettings) -> bool:
    """Tell whether a line of corners is one of the board's, by those of it that are seen.

    Where black squares end at the rim of the paper, every other place looks like a corner. A line of the
    board differs from those in its share of places, more than half, or in neighbouring corners in a row.

    Parameters
    ----------
    places : ndarray of int, shape (n,)
        Numbers of the corners along the line, each once.
    length : int
        Of the line, in corners.
    settings : SaddleSettings
    """
    if len(places) >= settings.min_line_share * length:
        return True
    ordered = np.sort(places)
    last = settings.min_line_run - 1
    return bool((ordered[last:] - ordered[: len(ordered) - last] == last).any())


def shows_outer_lines(nodes: Int[np.ndarray, "n 2"], settings: SaddleSettings) -> bool:
    """Tell whether the four outermost lines of nodes are lines of a board, as :func:`shows_line` has it.

    Parameters
    ----------
    nodes : ndarray of int, shape (n, 2)
        (col, row).
    settings : SaddleSettings
    """
    return all(
        shows_line(nodes[nodes[:, axis] == end, 1 - axis], int(np.ptp(nodes[:, 1 - axis])) + 1, settings)
        for axis in (0, 1)
        for end in (nodes[:, axis].min(), nodes[:, axis].max())
    )


def shown_lines(nodes: Int[np.ndarray, "n 2"], settings: SaddleSettings) -> Bool[np.ndarray, " n"]:
    """Tell which nodes are left when outermost lines that are none of a board are left out in turn.

    Parameters
    ----------
    nodes : ndarray of int, shape (n, 2)
        (col, row).
    settings : SaddleSettings
    """
    kept = np.ones(len(nodes), dtype=bool)
    while kept.any():
        left = nodes[kept]
        for axis, end in ((axis, of(left[:, axis])) for axis in (0, 1) for of in (np.min, np.max)):
            line = kept & (nodes[:, axis] == end)
            length = int(np.ptp(left[:, 1 - axis])) + 1
            if not shows_line(nodes[line, 1 - axis], length, settings):
                kept &= ~line
                break
        else:
            return kept
    return np.ones(len(nodes), dtype=bool)
