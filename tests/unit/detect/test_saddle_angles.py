"""Tests of the angles of edges at saddle points."""

import cv2
import numpy as np
import pytest

from labcal.detect.corners.saddle_angles import unturned
from labcal.detect.corners.saddles import Saddles, find_saddles
from labcal.detect.settings import DEFAULTS

FINER = 8
SIZE = 48
BLUR_PX = 0.75
"""With a pixel's own, 0.8 px."""


def corner(first: float, second: float, blur_px: float) -> np.ndarray:
    """Return a blurred chessboard's corner in the middle, with edges at two angles from x to y, rad."""
    at = (np.arange(FINER * SIZE) + 0.5) / FINER - 0.5 * SIZE
    x, y = np.meshgrid(at, at)
    white = np.sign((np.cos(first) * y - np.sin(first) * x) * (np.cos(second) * y - np.sin(second) * x))
    fine = cv2.GaussianBlur(120.0 + 80.0 * white, (0, 0), blur_px * FINER)
    return fine.reshape(SIZE, FINER, SIZE, FINER).mean(axis=(1, 3)).astype(np.float32)


def middle(saddles: Saddles) -> int:
    """Return the number of the saddle point in the middle."""
    away = np.linalg.norm(saddles.place - 0.5 * (SIZE - 1), axis=1)
    assert away.min() < 0.5
    return int(away.argmin())


@pytest.mark.parametrize("between", [0.6, 0.8, 1.0, 2.2, 2.4])
@pytest.mark.parametrize("first", [0.3, 1.9, 2.9])
def test_oblique_edges_have_the_angles_that_they_have_without_blur(first: float, between: float) -> None:
    found = find_saddles(corner(first, first + between, BLUR_PX), DEFAULTS.saddle)
    straight = unturned(found, DEFAULTS)
    k = middle(found)
    true = np.sort(np.mod([first, first + between], np.pi))
    off = np.mod(straight.edges[k] - true + 0.5 * np.pi, np.pi) - 0.5 * np.pi
    assert np.abs(off).max() < 0.05  # 0.08 to 0.18 before
    assert (straight.edges >= 0.0).all()
    assert (straight.edges < np.pi).all()
    assert (straight.edges[:, 0] < straight.edges[:, 1]).all()
    inside, outside = np.array([first + 0.5 * between, first + 0.5 * between + 0.5 * np.pi])
    colour = found.is_white(np.array([k, k]), np.array([inside, outside]))
    assert np.array_equal(straight.is_white(np.array([k, k]), np.array([inside, outside])), colour)


def test_without_saddle_points_there_are_no_angles() -> None:
    none = Saddles(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0, dtype=bool), np.zeros(0))
    assert len(unturned(none, DEFAULTS).place) == 0
