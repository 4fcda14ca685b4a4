"""Boards whose white is clipped: what is left of the edges is measured, as well as stated."""

import cv2
import numpy as np
import pytest

from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.targets.chessboard import Chessboard
from labcal.targets.grid import DotGrid

BOARD = Chessboard(kind="chessboard", name="held", cols=7, rows=6, square_mm=1.0)
DOTS = DotGrid(
    name="dots",
    cols=7,
    rows=6,
    pitch_x_mm=1.0,
    pitch_y_mm=1.0,
    dot_diameter_mm=0.54,
    rings=None,
    margin_mm=1.0,
)
SIZE, FINER = (360, 320), 8


def drawn(white: float, blur: float, across: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a picture, cut off at 255, and the corners' places; light rises by a share across it."""
    random = np.random.default_rng(seed)
    angle, (width, height) = 0.2 + 0.2 * random.uniform(), SIZE
    turned = 26.0 * np.array([[np.cos(angle), np.sin(angle)], [np.sin(angle), -np.cos(angle)]])
    H = np.eye(3)
    H[:2, :2], H[2, :2] = turned, random.uniform(-0.02, 0.02, 2)
    middle = np.array([3.0, 2.5])
    H[:2, 2] = [width / 2, height / 2] - turned @ middle
    y, x = (np.mgrid[: height * FINER, : width * FINER] + 0.5) / FINER - 0.5
    u, v, w = np.linalg.inv(H) @ np.stack([x.ravel(), y.ravel(), np.ones(x.size)])
    u, v = (u / w).reshape(x.shape), (v / w).reshape(x.shape)
    squares = (u > -1) & (u < BOARD.cols) & (v > -1) & (v < BOARD.rows)
    black = squares & ((np.floor(u) + np.floor(v)) % 2 == 0)
    light = np.where(black, 30.0, white).reshape(height, FINER, width, FINER).mean(axis=(1, 3))
    light = cv2.GaussianBlur(light, (0, 0), blur) * (1.0 + across * (np.arange(width) / width - 0.5))
    q = np.c_[BOARD.points()[:, :2], np.ones(BOARD.count)] @ H.T
    picture = np.clip(np.round(light + random.normal(0.0, 1.5, light.shape)), 0, 255)
    return picture.astype(np.uint8), q[:, :2] / q[:, 2:]


def squared_deviations(dots: PictureDots, q: np.ndarray) -> np.ndarray:
    number = {tuple(index): k for k, index in enumerate(BOARD.indices().tolist())}
    at = np.array([number[tuple(index)] for index in dots.index[dots.ok].tolist()])
    away = dots.position[dots.ok] - q[at]
    return np.einsum("ki,kij,kj->k", away, np.linalg.inv(dots.covariance[dots.ok]), away)


@pytest.mark.parametrize(("white", "blur", "across"), [(330.0, 0.8, 0.3), (400.0, 1.2, 0.0)])
def test_corners_beside_clipped_white_are_off_as_stated(white: float, blur: float, across: float) -> None:
    squares = []
    for seed in range(2):
        dots = detect_dots(*drawn(white, blur, across, seed)[:1], BOARD)
        assert dots.refusal is None
        assert dots.ok.sum() >= 0.9 * BOARD.count
        squares += squared_deviations(dots, drawn(white, blur, across, seed)[1]).tolist()
    assert 0.5 < np.mean(squares) / 2.0 < 1.33  # three standard deviations of 84 corners
    assert np.max(squares) < 4.5**2


def test_a_board_that_is_burnt_out_is_told() -> None:
    dots = detect_dots(drawn(900.0, 1.2, 0.0, 0)[0], BOARD)
    assert dots.refusal is not None
    assert "shorten the exposure time" in dots.detail


def dots_drawn(white: float, across: float, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """Return a picture of dots, cut off at 255, and their centres; light rises by a share across it."""
    random = np.random.default_rng(seed)
    angle, (width, height) = 0.1 + 0.2 * random.uniform(), SIZE
    turned = 40.0 * np.array([[np.cos(angle), np.sin(angle)], [np.sin(angle), -np.cos(angle)]])
    shift = np.array([width, height]) / 2 - turned @ np.array([3.0, 2.5]) + random.uniform(-0.5, 0.5, 2)
    y, x = (np.mgrid[: height * FINER, : width * FINER] + 0.5) / FINER - 0.5
    u, v = np.linalg.inv(turned) @ (np.stack([x.ravel(), y.ravel()]) - shift[:, None])
    i, j = np.round(u), np.round(v)
    black = (np.hypot(u - i, v - j) < 0.27) & (i >= 0) & (i < DOTS.cols) & (j >= 0) & (j < DOTS.rows)
    light = np.where(black, 30.0, white).reshape(height, FINER, width, FINER).mean(axis=(1, 3))
    light = cv2.GaussianBlur(light, (0, 0), 0.9) * (1.0 + across * (np.arange(width) / width - 0.5))
    picture = np.clip(np.round(light + random.normal(0.0, 1.2, light.shape)), 0, 255)
    return picture.astype(np.uint8), DOTS.indices() @ turned.T + shift


@pytest.mark.parametrize(("white", "across"), [(200.0, 0.3), (300.0, 0.3), (340.0, 0.3)])
def test_dots_on_clipped_white_in_uneven_light_are_off_as_stated(white: float, across: float) -> None:
    squares = []
    for seed in range(3):
        picture, q = dots_drawn(white, across, seed)
        dots = detect_dots(picture, DOTS)
        assert dots.refusal is None
        at = dots.position[dots.ok]
        away = at - q[np.linalg.norm(at[:, None] - q, axis=-1).argmin(axis=1)]
        squares += np.einsum("ki,kij,kj->k", away, np.linalg.inv(dots.covariance[dots.ok]), away).tolist()
    assert len(squares) > 100
    assert (
        0.4 < np.mean(squares) / 2.0 < 2.0
    )  # dots of a picture share what clipping moves them by: 19 before
