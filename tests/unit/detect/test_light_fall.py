"""Dots where light falls: the lens blurs light times print, and the fit's centres are of the print."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.detect.detector import detect_dots
from labcal.detect.edge_fit import EdgeFits, fit_edges
from labcal.detect.light_fall import in_falling_light
from labcal.detect.outlines.outlines import Outlines
from labcal.targets.catalogue import load_target

RADIUS, BLUR, PITCH, FINE, NOISE = 7.0, 2.0, 28.0, 5, 1.0
FALL = np.log(10.0) / 600.0  # of the light's logarithm, a px
Light = Callable[[np.ndarray], np.ndarray]


def falling(x: np.ndarray) -> np.ndarray:
    return np.exp(-FALL * x)


def shadow(x: np.ndarray) -> np.ndarray:
    return np.where(x < 10.5 * PITCH, 1.0, 0.6)  # its edge is between dots


def drawn(light: Light, levels: tuple[float, float]) -> tuple[np.ndarray, np.ndarray]:
    """Return a picture of 20 x 6 dots without noise, board and dot of two levels, and their centres."""
    grid = np.stack(np.meshgrid(np.arange(1.0, 21.0), np.arange(1.0, 7.0)), -1)
    centre = PITCH * grid + np.random.default_rng(3).uniform(-0.5, 0.5, grid.shape)
    w, h = int(21 * PITCH), int(7 * PITCH)
    x, y = np.meshgrid(*((np.arange(n * FINE) + 0.5) / FINE - 0.5 for n in (w, h)))
    col, row = (np.clip(np.round(v / PITCH).astype(int), 1, n) - 1 for v, n in ((x, 20), (y, 6)))
    own = centre[row, col]
    dot = np.clip((RADIUS - np.hypot(x - own[..., 0], y - own[..., 1])) * FINE + 0.5, 0.0, 1.0)
    seen = cv2.GaussianBlur((levels[0] + (levels[1] - levels[0]) * dot) * light(x), (0, 0), BLUR * FINE)
    return seen.reshape(h, FINE, w, FINE).mean((1, 3)), centre.reshape(-1, 2)


def fits_of(picture: np.ndarray, centre: np.ndarray, black: float) -> EdgeFits:
    """Return the fits of dots that are darker than the board."""
    n = len(centre)
    spots = Outlines(centre, np.tile(np.eye(2) * RADIUS**2, (n, 1, 1)), np.zeros(n), np.full(n, BLUR))
    return fit_edges(picture.astype(np.float32), spots, np.zeros(n), 2.5, black)


def shares(fits: EdgeFits, centre: np.ndarray) -> np.ndarray:
    """Return the squared errors of centres over their covariances, (n,)."""
    off = fits.centre - centre
    return np.asarray(np.einsum("ni,nij,nj->n", off, np.linalg.inv(fits.covariance), off))


@pytest.mark.parametrize("levels", [(220.0, 15.0), (15.0, 220.0)])
def test_errors_are_as_stated(levels: tuple[float, float]) -> None:
    """Of dark dots and of bright ones; without the slope of the light, centres are off by 0.016 px."""
    clean, centre = drawn(falling, levels)
    rng = np.random.default_rng(5)
    before, after, off = [], [], []
    for _ in range(4):
        picture, black = clean + rng.normal(0, NOISE, clean.shape), 0.0
        if levels[0] < levels[1]:  # detection looks for dark dots, in the negative if need be
            black = float(picture.max())
            picture = black - picture
        fits = fits_of(picture, centre, black)
        lit = in_falling_light(fits)
        np.testing.assert_array_equal(lit.covariance, fits.covariance)
        np.testing.assert_allclose(np.median(lit.light_slope, axis=0), [-FALL, 0.0], atol=2e-5)
        before.append(shares(fits, centre))
        after.append(shares(lit, centre))
        off.append((lit.centre - centre)[:, 0] / np.sqrt(lit.covariance[:, 0, 0]))
    dof = 2 * np.size(after)
    assert np.sum(before) - dof > 8 * np.sqrt(2 * dof)
    assert abs(np.sum(after) - dof) < 4 * np.sqrt(2 * dof)
    assert abs(np.mean(off)) < 4 / np.sqrt(np.size(off))


def test_even_light_leaves_centres() -> None:
    clean, centre = drawn(np.ones_like, (220.0, 15.0))
    fits = fits_of(clean + np.random.default_rng(6).normal(0, NOISE, clean.shape), centre, 0.0)
    moved = (in_falling_light(fits).centre - fits.centre) / np.sqrt(fits.covariance[:, [0, 1], [0, 1]])
    assert np.sqrt((moved**2).mean()) < 1e-2


def test_beside_the_edge_of_a_shadow_a_dot_has_its_own_slope() -> None:
    clean, centre = drawn(shadow, (220.0, 15.0))
    fits = fits_of(clean + np.random.default_rng(7).normal(0, NOISE, clean.shape), centre, 0.0)
    lit = in_falling_light(fits)
    beside = np.abs(centre[:, 0] - 10.5 * PITCH) < PITCH
    assert beside.sum() == 12
    np.testing.assert_array_equal(lit.light_slope[beside], fits.light_slope[beside])


def test_too_few_dots_have_their_own_slopes() -> None:
    clean, centre = drawn(falling, (220.0, 15.0))
    few = fits_of(clean, centre[:3], 0.0)
    np.testing.assert_array_equal(in_falling_light(few).light_slope, few.light_slope)
    in_line = fits_of(clean, centre[:20], 0.0)
    failed = replace(in_line, ok=np.zeros(20, dtype=bool))
    np.testing.assert_array_equal(in_falling_light(failed).light_slope, failed.light_slope)


def test_detected_dots_are_not_moved_by_falling_light(make_board: Callable[..., Any]) -> None:
    """Without the slope of the light their mean error is 0.4 and 0.6 of the stated one."""
    board = make_board(load_target("paper-13x10"), distance=900.0, blur=1.5, falloff=0.8, noise=1.0)
    dots = detect_dots(np.clip(np.round(board.draw()), 0, 255).astype(np.uint8), board.target)
    off = dots.position - [board.centroid((col, row)) for col, row in dots.index.tolist()]
    normed = (off / np.sqrt(dots.covariance[:, [0, 1], [0, 1]]))[dots.ok]
    assert len(normed) > 100
    assert np.abs(normed.mean(axis=0)).max() < 0.2
