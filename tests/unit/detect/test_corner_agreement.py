"""Corners that disagree with the others of their board: partly covered ones, and drawn numbers."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.boards.april_grid_ink import april_grid_ink
from labcal.bench.boards.april_grid_picture import NARROW
from labcal.bench.boards.charuco_picture import CharucoPicture, charuco_picture
from labcal.bench.boards.chessboard_picture import ChessboardPicture, chessboard_picture
from labcal.bench.marks.drawn_picture import Cover, Exposure, drawn
from labcal.detect.corners.corner_agreement import agreeing, without_disagreeing
from labcal.detect.detector import detect_dots
from labcal.detect.flags import DotFlag
from labcal.detect.grey import grey_picture

SIGMA = 0.02
HALF_COVERED = {
    "at a corner of what covers it": (
        [[47.254302, 29.855308, -118.210343], [30.832034, -49.561104, 184.055633], [-0.003984, -0.010214, 1]],
        (0.873, [0.00205, 0.0017], 0.0248),
        Cover(np.array([86.82, 236.33]), np.array([83.96, 90.64]), -2.0983, 0.212),
        (4, 3),
    ),
    "along its edge": (
        [[64.050575, -0.747075, -64.676147], [6.684722, -48.00703, 388.305574], [0.025645, 0.037915, 1]],
        (1.774, [-0.00097, -0.00252], 0.0135),
        Cover(np.array([139.47, 188.43]), np.array([61.45, 82.68]), 0.4655, 0.65),
        (4, 3),
    ),
}


@pytest.mark.parametrize("name", HALF_COVERED)
def test_corners_that_are_half_covered_are_not_measured(name: str) -> None:
    # A straight edge of what covers the corner is fitted as well as the tag's own: 5 and 0.1 px beside.
    H, (blur, gradient, noise), cover, corner = HALF_COVERED[name]
    how = Exposure((480, 360), np.array(H), blur, np.array(gradient), noise)
    seen = drawn(how, april_grid_ink(NARROW), (cover,), np.random.default_rng(1))
    dots = detect_dots(seen, NARROW)
    assert dots.refusal is None
    assert dots.ok.sum() > 40
    off = dots.position[dots.ok] - how.seen(NARROW.points(dots.index[dots.ok])[:, :2])
    squares = np.einsum("ni,nij,nj->n", off, np.linalg.inv(dots.covariance[dots.ok]), off)
    assert squares.max() < 25.0
    at = dots.index.tolist().index(list(corner))
    assert dots.flag[at] is DotFlag.BAD_FIT
    assert np.isnan(dots.position[at]).all()


@pytest.mark.parametrize(
    ("drawn_board", "number", "corner"), [(charuco_picture, 33, (6, 2)), (chessboard_picture, 14, (2, 1))]
)
def test_half_covered_corners_of_other_boards_are_not_measured(
    drawn_board: Callable[[int, int], CharucoPicture | ChessboardPicture],
    number: int,
    corner: tuple[int, int],
) -> None:
    # They were 2.6 and 1.1 px beside, 20 of their stated standard deviations and more.
    seen = drawn_board(number, 7701)
    dots = detect_dots(seen.picture, seen.board)
    assert dots.refusal is None
    off = dots.position[dots.ok] - seen.corner[dots.index[dots.ok] @ [1, seen.board.cols]]
    squares = np.einsum("ni,nij,nj->n", off, np.linalg.inv(dots.covariance[dots.ok]), off)
    assert squares.max() < 25.0
    at = dots.index.tolist().index(list(corner))
    assert dots.flag[at] is DotFlag.BAD_FIT


@pytest.mark.parametrize(("sigmas", "factor", "known"), [(3.6, 8.0, 107), (2.4, 8.0, 108), (3.6, 1.0, 108)])
def test_a_corner_that_is_mostly_covered_must_agree_more_closely(
    sigmas: float, factor: float, known: int
) -> None:
    # A corner with a large stated error is often fitted to what covers it.
    places, seen = _board(bend=0.0)
    random = np.random.default_rng(3)
    deviation = np.full(len(places), SIGMA)
    deviation[40] *= factor
    seen = seen + deviation[:, None] * random.normal(size=seen.shape)
    seen[40] = _board(bend=0.0)[1][40] + [sigmas * deviation[40], 0.0]
    covariance = deviation[:, None, None] ** 2 * np.eye(2)
    kept = agreeing(places, seen, covariance)
    assert kept.sum() == known
    assert np.delete(kept, 40).all()


def _board(bend: float, tilt: float = 0.2) -> tuple[np.ndarray, np.ndarray]:
    """Return places (n, 2) on a board of 12 x 9, and where a tilted camera with a lens sees them, px."""
    places = np.stack(np.meshgrid(np.arange(12.0), np.arange(9.0)), axis=-1).reshape(-1, 2)
    x, y = ((places - [5.5, 4.0]) / 6.0).T
    u, v = np.stack([x, y + 0.1 * x]) / (1.0 + tilt * x)
    radius = u * u + v * v
    return places, 300.0 + 280.0 * np.stack([u, v], axis=1) * (1.0 + bend * radius)[:, None]


@pytest.mark.parametrize("bend", [0.0, -0.08, -0.15])
def test_true_corners_agree_through_any_lens_and_single_wrong_ones_do_not(bend: float) -> None:
    places, true = _board(bend)
    lost = found = spoilt = 0
    for seed in range(16):
        random = np.random.default_rng(seed)
        sigma = SIGMA * np.where(random.uniform(size=len(true)) < 0.1, 10.0, 1.0)
        seen = true + sigma[:, None] * random.standard_normal(true.shape)
        covariance = sigma[:, None, None] ** 2 * np.eye(2)
        lost += int((~agreeing(places, seen, covariance)).sum())
        # Of the best corners or the worst ones, eight of their own standard deviations.
        wrong = random.permutation(len(true))[:3]
        way = random.uniform(-np.pi, np.pi, 3)
        seen[wrong] += 8.0 * sigma[wrong, None] * np.stack([np.cos(way), np.sin(way)], axis=1)
        kept = agreeing(places, seen, covariance)
        found += int((~kept[wrong]).sum())
        spoilt += int((~kept).sum() - (~kept[wrong]).sum())
    # One picture in a hundred loses a corner: of 16 more than two by a chance of 1 in 1,000.
    assert lost <= 2
    assert spoilt <= 2
    assert found >= 0.9 * 3 * 16


def test_a_ragged_print_is_no_wrong_corner() -> None:
    places, true = _board(-0.08)
    for seed in range(8):
        random = np.random.default_rng(seed)
        seen = true + 6.0 * SIGMA * random.standard_normal(true.shape)
        assert (~agreeing(places, seen, np.tile(SIGMA**2 * np.eye(2), (len(true), 1, 1)))).sum() <= 1


@pytest.mark.parametrize(("cols", "rows"), [(9, 6), (13, 8)])
@pytest.mark.parametrize("half_angle_deg", [30.0, 55.0, 80.0])
@pytest.mark.parametrize("bend", [0.0, 0.3])
def test_no_true_corner_is_lost_through_a_fisheye_or_on_a_bent_board(
    cols: int, rows: int, half_angle_deg: float, bend: float
) -> None:
    # No polynomial of these degrees follows such a lens within 0.01 px: what it leaves is no wrong corner.
    places = np.stack(np.meshgrid(np.arange(float(cols)), np.arange(float(rows))), axis=-1).reshape(-1, 2)
    away = places - 0.5 * np.array([cols - 1.0, rows - 1.0])
    x, y = (away / np.linalg.norm(away, axis=1).max()).T
    lost = 0
    for seed in range(8):
        random = np.random.default_rng(seed)
        tilt, turn = random.uniform(0.0, 0.6), random.uniform(-np.pi, np.pi)
        across = np.cos(turn) * x + np.sin(turn) * y
        X, Z = np.cos(tilt) * x, np.sin(tilt) * x + 0.5 * bend * across**2
        Z = Z + max(1.0 / np.tan(np.radians(half_angle_deg)), 0.05 - Z.min())
        radius = np.hypot(X, y)
        along = 200.0 * np.arctan2(radius, Z) / np.maximum(radius, 1e-9)
        sigma = 0.01 if seed % 2 else 0.04
        seen = along[:, None] * np.stack([X, y], axis=1) + sigma * random.standard_normal(places.shape)
        lost += int((~agreeing(places, seen, np.tile(sigma**2 * np.eye(2), (len(places), 1, 1)))).sum())
    assert lost <= 1


@pytest.mark.parametrize("count", [0, 1, 3, 4, 5])
def test_few_corners_tell_nothing(count: int) -> None:
    places, seen = (part[[0, 11, 96, 107, 50]][:count] for part in _board(0.0))
    seen = seen + 40.0 * (np.arange(count) == 1)[:, None]
    assert agreeing(places, seen, np.tile(SIGMA**2 * np.eye(2), (count, 1, 1))).all()


def test_corners_on_a_line_tell_nothing() -> None:
    places, seen = (part[:12] for part in _board(0.0))
    assert agreeing(places, seen, np.tile(SIGMA**2 * np.eye(2), (12, 1, 1))).all()


def test_flags_of_the_others_stay() -> None:
    places, true = _board(0.0)
    grey = grey_picture(np.full((360, 480), 90, dtype=np.uint8))
    none = detect_dots(grey, NARROW)
    n = len(true)
    seen = true.copy()
    seen[7] += 3.0
    flags = [DotFlag.OK] * n
    flags[3] = DotFlag.CUT
    dots = replace(
        none, refusal=None, index=places.astype(np.int64), has_id=np.ones(n, dtype=bool), position=seen,
        covariance=np.tile(SIGMA**2 * np.eye(2), (n, 1, 1)), misfit=np.full(n, np.nan), flag=tuple(flags),
        seen_at=seen, outline=np.full((n, 2, 2), np.nan),
    )  # fmt: skip
    judged = without_disagreeing(dots, places)
    assert [k for k, flag in enumerate(judged.flag) if flag is DotFlag.BAD_FIT] == [7]
    assert judged.flag[3] is DotFlag.CUT
    assert np.isnan(judged.position[7]).all()
    assert np.array_equal(judged.seen_at, seen)
