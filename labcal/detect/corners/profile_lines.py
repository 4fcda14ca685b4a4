"""Profiles of a blurred edge at all pixels of a chunk, by the table of a single one, in compiled code."""

from math import floor

import numpy as np

from labcal.detect.compiled import inlined
from labcal.detect.corners.corner_chunks import CHUNK
from labcal.detect.corners.edge_profile import FARTHEST, PER_BLUR, PROFILE, SLOPE, beside_entry

_BLURS = 1.0 / PER_BLUR


@inlined
def write_profiles(space: np.ndarray, index: np.ndarray, at: int, profile: int, slope: int) -> None:
    """Write the profiles and slopes at a line's distances, in blurs, to two other lines of a chunk.

    Entries are looked up in a loop of their own: the other ones take several pixels at a time.

    Parameters
    ----------
    space : ndarray
        The chunk's lines.
    index : ndarray of int, shape (CHUNK,)
        Workspace.
    at, profile, slope : int
        Where the lines begin.
    """
    for k in range(CHUNK):
        index[k] = int(PER_BLUR * min(abs(space[at + k]), FARTHEST) + 0.5)
    for k in range(CHUNK):
        entry = index[k]
        space[profile + k], space[slope + k] = PROFILE[entry], SLOPE[entry]
    for k in range(CHUNK):
        size = min(abs(space[at + k]), FARTHEST)
        a = _BLURS * floor(PER_BLUR * size + 0.5)
        value, by = beside_entry(size, a, space[profile + k], space[slope + k])
        space[profile + k], space[slope + k] = (value if space[at + k] > 0.0 else -value), by
