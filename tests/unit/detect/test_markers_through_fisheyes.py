"""Boards with large markers, seen through wide lenses: no homography predicts a marker from the next ones."""

import numpy as np
import pytest

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.detect.corners.marker_agreement import AgreeingMarkers, markers_that_agree
from labcal.detect.corners.seen_markers import SeenMarkers
from labcal.detect.corners.tag_places import tag_corners
from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.detect.lattice.rough_undistortion import fisheyes
from labcal.detect.settings import DEFAULTS
from labcal.targets.april_grid import AprilGrid

SIZE = (480, 360)
FOCAL = 210.0
"""px: the diagonal's ends are 164 degrees apart."""
MIDDLE = np.array([243.0, 177.0])
GRID = AprilGrid(kind="aprilgrid", name="wide", tag_cols=6, tag_rows=4, tag_mm=1.0, tag_spacing=0.3)
LENSES = fisheyes(SIZE, DEFAULTS.grid.fisheye_fields_deg)
LIMIT = DEFAULTS.corner.max_marker_residual_squares * GRID.tag_spacing
SAMPLES = 4  # a side of a pixel


def pose(tilt: float, distance: float) -> tuple[np.ndarray, np.ndarray]:
    """Return R, t of the grid, its middle on the axis, turned about its x axis by degrees."""
    c, s = np.cos(np.radians(tilt)), np.sin(np.radians(tilt))
    R = np.array([[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]) @ np.diag([1.0, -1.0, -1.0])
    return R, np.array([0.0, 0.0, distance]) - R @ GRID.points().mean(axis=0)


def seen_at(board: np.ndarray, R: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return pixels of places on the board (..., 2) through an equidistant lens."""
    x, y, z = np.moveaxis(board @ R[:, :2].T + t, -1, 0)
    across = np.hypot(x, y)
    scale = FOCAL * np.arctan2(across, z) / np.maximum(across, 1e-12)
    return MIDDLE + np.stack([x, y], axis=-1) * scale[..., None]


def picture(R: np.ndarray, t: np.ndarray) -> np.ndarray:
    """Return the drawn picture of the grid, the mean of samples in every pixel, blurred and with noise."""
    x, y = (
        (np.arange(n * SAMPLES) + 0.5) / SAMPLES - 0.5 - middle
        for n, middle in zip(SIZE, MIDDLE, strict=True)
    )
    u, v = np.meshgrid(x / FOCAL, y / FOCAL)
    angle = np.hypot(u, v)
    scale = np.tan(np.minimum(angle, 1.5)) / angle
    rays = np.stack([u * scale, v * scale, np.ones_like(u)])
    X, Y, w = np.einsum("ij,jyx->iyx", np.linalg.inv(np.column_stack([R[:, :2], t])), rays)
    black = april_grid_ink(GRID)(X / w, Y / w)
    black = black.reshape(SIZE[1], SAMPLES, SIZE[0], SAMPLES).mean(axis=(1, 3))
    padded = np.pad(black, 1, mode="edge")
    black = (padded[:-2, 1:-1] + padded[2:, 1:-1] + padded[1:-1, :-2] + padded[1:-1, 2:] + 4.0 * black) / 8.0
    noise = np.random.default_rng(0).normal(0.0, 1.0, black.shape)
    return np.clip(np.rint(210.0 - 180.0 * black + noise), 0, 255).astype(np.uint8)


@pytest.mark.parametrize(("tilt", "distance"), [(0.0, 4.0), (20.0, 4.6)])
def test_a_whole_grid_through_a_fisheye_is_measured(tilt: float, distance: float) -> None:
    R, t = pose(tilt, distance)
    dots = detect_dots(picture(R, t), GRID)
    assert dots.refusal is None
    off = dots.position[dots.ok] - seen_at(GRID.points(dots.index[dots.ok])[:, :2], R, t)
    assert len(off) > 0.9 * GRID.count
    assert np.abs(off).max() < 0.1


def placed(numbers: np.ndarray, board: np.ndarray, *, mirror: float = 1.0) -> AgreeingMarkers:
    """Return the markers that agree of tags with these numbers, printed at places of a board."""
    corners = seen_at(board, *pose(12.0, 4.0)) * [mirror, 1.0]
    return markers_that_agree(SeenMarkers(numbers, corners), tag_corners(GRID)[numbers], LIMIT, LENSES)


def test_every_tag_agrees_through_a_fisheye_and_half_do_not_without_it() -> None:
    numbers, board = np.arange(GRID.tag_count), tag_corners(GRID)
    assert sorted(placed(numbers, board).which) == numbers.tolist()
    seen = SeenMarkers(numbers, seen_at(board, *pose(12.0, 4.0)))
    assert markers_that_agree(seen, board, LIMIT).which == []


@pytest.mark.parametrize(("cols", "rows"), [(5, 5), (4, 6), (7, 4), (8, 3), (3, 8)])
def test_a_grid_of_other_columns_does_not_agree_through_a_fisheye(cols: int, rows: int) -> None:
    other = GRID.model_copy(update={"tag_cols": cols, "tag_rows": rows})
    numbers = np.arange(min(other.tag_count, GRID.tag_count))
    assert placed(numbers, tag_corners(other)[numbers]).which == []


@pytest.mark.parametrize("spacing", [0.1, 0.5, 0.8])
def test_a_grid_of_another_spacing_does_not_agree_through_a_fisheye(spacing: float) -> None:
    other = GRID.model_copy(update={"tag_spacing": spacing})
    assert placed(np.arange(GRID.tag_count), tag_corners(other)).which == []


@pytest.mark.parametrize("seed", range(4))
def test_tags_in_other_places_or_in_a_mirror_do_not_agree_through_a_fisheye(seed: int) -> None:
    numbers = np.random.default_rng(seed).permutation(GRID.tag_count)
    assert placed(numbers, tag_corners(GRID)).which == []
    assert placed(np.sort(numbers), tag_corners(GRID), mirror=-1.0).which == []


@pytest.mark.parametrize("side", [0.8, 1.2])
def test_tags_of_another_side_are_told_by_their_places(side: float) -> None:
    # Pitch and tags of the print do not go together as on the target.
    corners = tag_corners(GRID)
    middle = corners.mean(axis=1, keepdims=True)
    assert placed(np.arange(GRID.tag_count), middle + side * (corners - middle)).which == []


def test_another_grid_through_a_fisheye_is_refused() -> None:
    R, t = pose(0.0, 4.0)
    other = GRID.model_copy(update={"tag_cols": 4, "tag_rows": 6})
    assert detect_dots(picture(R, t), other).refusal is Refusal.OTHER_BOARD
