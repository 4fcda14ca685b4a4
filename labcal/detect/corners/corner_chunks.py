"""Pixels of a corner in chunks, in lines at constant places, for compiled code.

A loop over whole chunks, within one array, compiles to instructions that take several pixels at a time.
"""

from typing import NamedTuple

import numpy as np

from labcal.detect.compiled import compiled

CHUNK = 128
"""Pixels that are linearised together, so few that they stay in the nearest cache."""
X, Y, VALUE, A, B, FAR_A, FAR_B = (CHUNK * line for line in range(7))
"""Beginnings of the lines of a chunk that is kept: offset, value, distances from both edges in blurs, and
distances along them, px."""
_KEPT = 7
BOARD = 12 * CHUNK
OFF_EDGES, BY_A, BY_B, BY_CORRELATION, AT_A, AT_B, PROFILE_A, SLOPE_A, PROFILE_B, SLOPE_B = (
    BOARD + CHUNK * line for line in range(1, 11)
)
"""Beginnings of lines of the workspace, behind those of the table of derivatives: the pattern, the smaller
distance from the edges in blurs, the pattern's derivatives by both distances and the correlation; both
distances and the edges' own profiles there."""
_LINES = 23


class Room(NamedTuple):
    """The pixels of a corner in chunks, and workspace.

    Attributes
    ----------
    kept : ndarray, shape (chunks, 7 CHUNK)
        What is kept of every chunk; 0 for the pixels that the last one has too much.
    space : ndarray, shape (23 CHUNK,)
        Workspace of one chunk.
    entry : ndarray of int, shape (CHUNK,)
        Workspace.
    near : ndarray of int, shape (n + 1,)
        Numbers of the pixels near both edges; room for one more.
    beside : ndarray, shape (4, n)
        What both edges together make of these.
    """

    kept: np.ndarray
    space: np.ndarray
    entry: np.ndarray
    near: np.ndarray
    beside: np.ndarray


@compiled
def room_of(offset: np.ndarray, value: np.ndarray) -> Room:
    """Return pixels in chunks, of offsets (2, n) and values (n,), with workspace."""
    n = len(value)
    kept = np.empty((-(-n // CHUNK), _KEPT * CHUNK))
    for chunk in range(len(kept)):
        own, first = kept[chunk], chunk * CHUNK
        count = min(CHUNK, n - first)
        x, y, v = offset[0, first : first + count], offset[1, first : first + count], value[first:]
        for k in range(count):
            own[X + k], own[Y + k], own[VALUE + k] = x[k], y[k], v[k]
        for k in range(count, CHUNK):
            own[X + k] = own[Y + k] = own[VALUE + k] = 0.0
    space, entry = np.zeros(_LINES * CHUNK), np.empty(CHUNK, dtype=np.int64)
    return Room(kept, space, entry, np.empty(n + 1, dtype=np.int64), np.empty((4, n)))
