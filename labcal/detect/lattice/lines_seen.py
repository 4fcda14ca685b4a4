"""Columns and rows of a grid that are seen in a picture, and where, in words."""

import numpy as np

from labcal.arrays import DotIndices, Pixels


def lines_words(nodes: DotIndices, q: Pixels, noun: str, declared: tuple[int, int]) -> str:
    """Return how many columns and rows are seen and where, as a sentence.

    Parameters
    ----------
    nodes : ndarray of int, shape (n, 2)
        Of a lattice, up to a turn.
    q : ndarray, shape (n, 2)
        Where they are seen, px.
    noun : str
        Of several of them.
    declared : (int, int)
        Columns and rows of the target.
    """
    first, second = (int(n) for n in np.ptp(nodes, axis=0) + 1)
    design = np.column_stack([nodes.astype(np.float64), np.ones(len(nodes))])
    step = np.linalg.lstsq(design, q, rcond=None)[0][0]
    across, up = (first, second) if abs(step[0]) >= abs(step[1]) else (second, first)
    return (
        f"{across} columns and {up} rows of {noun} were seen {where_words(q)}; the target has "
        f"{declared[0]} and {declared[1]}."
    )


def where_words(q: Pixels) -> str:
    """Return the part of the picture that places (n, 2) span, in words, px."""
    (left, top), (right, bottom) = np.round(q.min(axis=0)).astype(int), np.round(q.max(axis=0)).astype(int)
    return f"between x = {left} and {right} and y = {top} and {bottom} px"
