"""Corners of large squares whose edges a lens bends."""

import cv2
import numpy as np
import pytest
from scipy.special import erf

from labcal.detect.corners.board_lens import BoardLens, board_lens
from labcal.detect.corners.lens_edges import edge_runs, straighten
from labcal.detect.corners.lens_maps import moved_beyond
from labcal.detect.corners.local_maps import LocalMaps, local_maps
from labcal.detect.detector import detect_dots
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.chessboard import Chessboard

SIZE = (960, 720)
COLS, ROWS, BLUR = 8, 5, 0.8
NODES = np.array([(i, j) for j in range(ROWS) for i in range(COLS)])
CENTRE = np.array([482.8, 356.8])
TILT = np.array([[0.95, 0.1, -0.2], [0.12, -0.97, 0.15], [-0.18, -0.17, -0.97]])


def plane(distance: float) -> np.ndarray:
    """Return the homography from squares to directions of the camera, of a board so many squares away."""
    middle = np.array([(COLS - 1) / 2, (ROWS - 1) / 2, 0.0])
    return np.column_stack([TILT[:, 0], TILT[:, 1], np.array([0.0, 0.0, distance]) - TILT @ middle])


def fisheye(places: np.ndarray, distance: float = 4.8, focal: float = 420.0) -> np.ndarray:
    """Return where an equidistant fisheye sees places on the board (n, 2), px."""
    x, y, z = plane(distance) @ np.column_stack([places, np.ones(len(places))]).T
    angle, across = np.arctan2(np.hypot(x, y), z), np.hypot(x, y)
    return CENTRE + focal * np.stack([x, y], axis=1) * (angle / np.maximum(across, 1e-12))[:, None]


def pinhole(places: np.ndarray, distance: float = 9.0, focal: float = 900.0) -> np.ndarray:
    """Return where a camera without distortion sees places on the board (n, 2), px."""
    x, y, z = plane(distance) @ np.column_stack([places, np.ones(len(places))]).T
    return CENTRE + focal * np.stack([x / z, y / z], axis=1)


def on_board(to_rays: np.ndarray, focal: float) -> tuple[np.ndarray, np.ndarray]:
    """Return the places on the board that the pixels of a fisheye's picture show, shape (h, w) each."""
    x, y = (grid - c for grid, c in zip(np.meshgrid(*map(np.arange, SIZE)), CENTRE, strict=True))
    radius = np.maximum(np.hypot(x, y), 1e-9)
    rays = np.stack([x, y, radius / np.tan(radius / focal)], axis=-1)
    a, b, w = np.moveaxis(rays @ np.linalg.inv(to_rays).T, -1, 0)
    return a / w, b / w


def drawn(to_rays: np.ndarray, focal: float, seed: int) -> np.ndarray:
    """Return a fisheye's picture of the board: every edge blurred across, as it runs there."""
    profiles = []
    for place, last in zip(on_board(to_rays, focal), (COLS, ROWS), strict=True):
        down, across = np.gradient(place)
        line = np.clip(np.round(place), 0, last - 1)
        away = (place - line) / np.hypot(across, down)
        profiles.append(np.where(line % 2 == 0, 1.0, -1.0) * erf(away / (BLUR * np.sqrt(2.0))))
    light = 118.0 + 92.0 * profiles[0] * profiles[1]
    for place, last in zip(on_board(to_rays, focal), (COLS, ROWS), strict=True):
        light[(place < -1.0) | (place > last)] = 210.0
    noise = np.random.default_rng(seed).normal(0.0, 1.5, light.shape)
    return np.clip(np.round(light + noise), 0, 255).astype(np.uint8)


def test_corners_of_large_squares_behind_a_fisheye_are_as_exact_as_they_state() -> None:
    board = Chessboard(
        kind="chessboard", name="board", cols=COLS, rows=ROWS, square_mm=25.0, lower_left="white"
    )
    dots = detect_dots(drawn(plane(4.8), 420.0, 0), board)
    assert dots.ok.sum() == COLS * ROWS
    off = dots.position - fisheye(dots.index.astype(np.float64))
    squares = np.einsum("ni,nij,nj->n", off, np.linalg.inv(dots.covariance), off)
    # Without the lens 0.02 px and 12; the curvature and third order of edges at the rim are extrapolated.
    assert np.sqrt((off**2).mean()) < 0.004
    assert 0.5 < squares.mean() / 2.0 < 1.4
    assert np.sqrt(eigenvalues(dots.covariance).mean()) < 0.004


def test_a_tilted_board_behind_a_fisheye_is_seen_whole() -> None:
    """Its squares shrink by a fifth from row to row, towards the frame."""
    turn = cv2.Rodrigues(np.array([0.0, 0.0, 0.506]))[0] @ cv2.Rodrigues(np.array([0.559, 0.419, 0.0]))[0]
    turn = turn @ np.diag([1.0, -1.0, -1.0])
    middle = np.array([0.0, 0.0, 4.8]) - turn @ np.array([3.48, 2.0, 0.0])
    board = Chessboard(
        kind="chessboard", name="board", cols=COLS, rows=ROWS, square_mm=25.0, lower_left="white"
    )
    picture = drawn(np.column_stack([turn[:, 0], turn[:, 1], middle]), 420.0, 0)
    assert detect_dots(picture, board).ok.sum() == COLS * ROWS


@pytest.mark.parametrize("noise", [0.02, 0.0])
def test_corners_without_distortion_demand_no_lens(noise: float) -> None:
    for seed in range(20):
        q = pinhole(NODES.astype(np.float64))
        q += noise * np.random.default_rng(seed).normal(size=q.shape)
        assert board_lens(NODES, q, SIZE) is None


def test_a_lens_is_found_beside_corners_that_something_covers() -> None:
    q = fisheye(NODES.astype(np.float64))
    covered = q + 0.01 * np.random.default_rng(1).normal(size=q.shape)
    covered[[3, 12, 30]] += [[1.5, 0.4], [-0.7, 0.9], [0.3, -2.0]]
    lens = board_lens(NODES, covered, SIZE)
    assert lens is not None
    assert np.abs(lens.in_picture(NODES, q) - q).max() < 0.03
    # Of a fisheye the terms are those of r / tan r.
    per = lens.unit / 420.0
    assert lens.terms[0] == pytest.approx(-(per**2) / 3.0, abs=0.02)


def exact_lens() -> BoardLens:
    """Return the lens of exact corners."""
    lens = board_lens(NODES, fisheye(NODES.astype(np.float64)), SIZE)
    assert lens is not None
    return lens


def test_too_few_corners_tell_no_lens() -> None:
    few = NODES[[0, 1, 2, 8, 9, 10, 16, 17, 18]]
    assert board_lens(few, fisheye(few.astype(np.float64)), SIZE) is None


def test_edges_are_straight_where_their_pixels_are_moved() -> None:
    q = fisheye(NODES.astype(np.float64))
    runs = edge_runs(exact_lens(), NODES, q, (0.5, 60.0))
    for k, node in enumerate(NODES):
        for axis in (0, 1):
            places = np.repeat(node[None].astype(np.float64), 11, axis=0)
            places[:, axis] += np.linspace(-0.45, 0.45, 11)
            offset = np.ascontiguousarray((fisheye(places) - q[k]).T)
            tangent = runs[k, axis, :2]
            bent = np.abs(offset[1] * tangent[0] - offset[0] * tangent[1]).max()
            straighten(offset, runs[k])
            left = np.abs(offset[1] * tangent[0] - offset[0] * tangent[1]).max()
            assert left < max(2e-3, 0.01 * bent)


def place_of(maps: LocalMaps, k: int, away: np.ndarray) -> np.ndarray:
    """Return the step on the board of an offset (2,), px, by the map of a corner."""
    x, y = moved_beyond(away[:, None], maps.beyond[k])[:, 0]
    r = np.array([x, y])
    square = np.array([0.5 * x * x, x * y, 0.5 * y * y])
    cube = np.array([x**3 / 6.0, 0.5 * x * x * y, 0.5 * x * y * y, y**3 / 6.0])
    step = maps.linear[k] @ r / (1.0 + maps.perspective[k] @ r)
    return np.asarray(step + maps.square[k] @ square + maps.cube[k] @ cube)


def test_maps_around_corners_of_charuco_boards_follow_a_fisheye_at_the_rim_too() -> None:
    q = fisheye(NODES.astype(np.float64))
    nodes = [(int(i), int(j)) for i, j in NODES]
    maps = local_maps(nodes, q, np.full(len(q), 0.01), SIZE)
    assert maps.known.all()
    for k, node in enumerate(NODES):
        step = np.array([0.4, -0.4])
        away = fisheye((node + step)[None])[0] - q[k]
        # 0.003 of some 90 px; without the lens up to 0.02 squares.
        assert np.abs(place_of(maps, k, away) - step).max() < 3e-5
