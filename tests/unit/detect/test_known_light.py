"""The slope of the light that the levels of corners tell."""

import numpy as np

from labcal.detect.corners.known_light import light_slopes
from labcal.detect.corners.node_grid import NodeGrid

NODES = [(i, j) for j in range(5) for i in range(7)]
PLACES = np.array(NODES) @ np.array([[22.0, 4.0], [-3.0, 20.0]]) + 40.0
SLOPE = np.array([5e-4, -2e-4])


def slopes(white: np.ndarray) -> np.ndarray:
    """Return the slopes at all corners."""
    return light_slopes(NodeGrid.of(NODES), PLACES, white, ((1, 2, 4), 5))


def test_a_level_of_what_covers_a_corner_does_not_turn_the_slope_of_the_others() -> None:
    noise = 1.0 + 0.003 * np.random.default_rng(2).normal(size=len(NODES))
    white = 170.0 * np.exp(PLACES @ SLOPE) * noise
    clean = slopes(white)
    assert np.abs(clean - SLOPE).max() < 3e-4
    white[16] *= 1.6
    # At the corner itself and in the picture's corners few levels are left beside it.
    assert np.abs(slopes(white) - SLOPE).max() < 6e-4


def test_too_few_levels_tell_no_slope() -> None:
    white = np.full(len(NODES), np.nan)
    white[:4] = 170.0
    assert np.isnan(slopes(white)).all()
