"""Outlines of the print of several boards, side by side in one plane."""

import numpy as np
from matplotlib.path import Path as Outline

from labcal.targets.board_set import BoardSet
from labcal.targets.one_sheet import require_one_sheet


def board_set_outlines(boards: BoardSet) -> Outline:
    """Return the outlines of all that is printed on the boards, mm in the frame of the first one.

    Raises
    ------
    InputError
        As of :func:`require_one_sheet`.
    """
    from labcal.targets.shapes import printed_outlines  # noqa: PLC0415 -- it draws kinds from the registry

    require_one_sheet(boards)
    parts = []
    for board, T in zip(boards.targets, boards.poses, strict=True):
        outline = printed_outlines(board)
        places = np.asarray(outline.vertices) @ T[:2, :2].T + T[:2, 3]
        parts.append(Outline(places, outline.codes))
    return Outline.make_compound_path(*parts)
