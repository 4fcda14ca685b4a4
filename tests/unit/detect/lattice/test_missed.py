"""Nodes that were added to a lattice over a gap, and what becomes of those that were guessed wrong."""

import numpy as np

from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.missed import _consistent
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.stage_settings.grid import GridSettings

ROWS = 6


def place(a: float, b: float) -> tuple[float, float]:
    """Return a node's place at the rim of a wide lens: steps shrink along a."""
    return 100.0 + 40.0 * a - 1.3 * a * a, 100.0 + 30.0 * b


def test_a_dot_behind_the_one_that_was_meant_is_given_up() -> None:
    known = {(a, b): place(a, b) for a in range(8) for b in range(ROWS)}
    right = {(8, b): place(8, b) for b in range(3)}
    wrong = {(10, 1): place(11, 1)}  # the dot at 9 is hidden
    nodes = [*known, *right, *wrong]
    spots = {node: number for number, node in enumerate(nodes)}
    centre = np.array([*known.values(), *right.values(), *wrong.values()])
    n = len(nodes)
    outlines = Outlines(centre, np.tile(25.0 * np.eye(2), (n, 1, 1)), np.zeros(n), np.ones(n))
    assert set(_consistent(Lattice(spots), outlines, len(known), GridSettings()).spots) == {*known, *right}
