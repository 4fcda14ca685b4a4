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
    many = (np.ptp(nodes, axis=0) + 1).tolist()
    design = np.column_stack([nodes.astype(np.float64), np.ones(len(nodes))])
    step = np.linalg.lstsq(design, q, rcond=None)[0][0]
    across = 0 if abs(step[0]) >= abs(step[1]) else 1
    words = (
        f"{many[across]} columns and {many[1 - across]} rows of {noun} were seen {where_words(q)}; "
        f"the target has {declared[0]} and {declared[1]}."
    )
    return words + _thin_line_words(nodes, q, noun, across)


def _thin_line_words(nodes: DotIndices, q: Pixels, noun: str, across: int) -> str:
    """Return a sentence on the outermost line of which least is seen, if less than half of it is."""
    ends = [(axis, end) for axis in (0, 1) for end in (nodes[:, axis].min(), nodes[:, axis].max())]
    lines = [nodes[:, axis] == end for axis, end in ends]
    full = [int(np.ptp(nodes[:, 1 - axis])) + 1 for axis, _ in ends]
    thinnest = min(range(len(ends)), key=lambda k: lines[k].sum() / full[k])
    seen, axis = int(lines[thinnest].sum()), ends[thinnest][0]
    if 2 * seen >= full[thinnest]:
        return ""
    away = q[lines[thinnest]].mean(axis=0) - q.mean(axis=0)
    if axis == across:
        line = f"{'leftmost' if away[0] < 0.0 else 'rightmost'} column"
    else:
        line = f"{'top' if away[1] < 0.0 else 'bottom'} row"
    return f" Of the {line} {seen} of {full[thinnest]} {noun} were seen."


def where_words(q: Pixels) -> str:
    """Return the part of the picture that places (n, 2) span, in words, px."""
    (left, top), (right, bottom) = np.round(q.min(axis=0)).astype(int), np.round(q.max(axis=0)).astype(int)
    return f"between x = {left} and {right} and y = {top} and {bottom} px"
