"""Names of dots for people, with the board that they are on where the target has several."""

import numpy as np
from jaxtyping import Int64

from labcal.correspond.boards_points import own_indices
from labcal.targets.board_set import BoardSet


def dot_words(index: Int64[np.ndarray, "n 2"], target: object) -> list[str]:
    """Return ``dot 3, 4`` of each dot; of several boards ``board-a, dot 3, 4``.

    Parameters
    ----------
    index : ndarray of int, shape (n, 2)
        (col, row) on the target.
    target : object
        Of a set of boards, the numbers are those of the set.
    """
    if not isinstance(target, BoardSet):
        return [f"dot {col}, {row}" for col, row in index.tolist()]
    own, names = own_indices(index, target)
    return [f"{name}, dot {col}, {row}" for name, (col, row) in zip(names, own.tolist(), strict=True)]
