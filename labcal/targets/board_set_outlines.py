"""Outlines of the print of several boards, side by side in one plane."""

import numpy as np
from matplotlib.path import Path as Outline

from labcal.errors import InputError
from labcal.targets.board_set import BoardSet

_FLAT_MM = 1e-6


def board_set_outlines(boards: BoardSet) -> Outline:
    """Return the outlines of all that is printed on the boards, mm in the frame of the first one.

    Raises
    ------
    InputError
        The boards do not lie in one plane, so that no sheet holds them.
    """
    from labcal.targets.shapes import printed_outlines  # noqa: PLC0415 -- it draws kinds from the registry

    parts = []
    for board, T in zip(boards.targets, boards.poses, strict=True):
        if abs(T[2, 3]) > _FLAT_MM or np.abs(T[2, :2]).max() > _FLAT_MM or T[2, 2] < 0.0:
            raise InputError(
                f"The boards of '{boards.name}' do not lie in one plane. Draw each by itself: 'labcal target "
                f"export {board.name}'."
            )
        outline = printed_outlines(board)
        places = np.asarray(outline.vertices) @ T[:2, :2].T + T[:2, 3]
        parts.append(Outline(places, outline.codes))
    return Outline.make_compound_path(*parts)
