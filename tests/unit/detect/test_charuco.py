"""ChArUco corners in pictures of OpenCV's own board, seen by OpenCV's camera: ids, places, covariances."""

import cv2
import numpy as np
import pytest
from scipy.special import owens_t
from scipy.stats import chi2

from labcal.bench.detect.developed import PictureKind, SensorNoise, taken_picture
from labcal.bench.solve.board_poses import board_poses
from labcal.bench.solve.board_set import DrawnViews
from labcal.detect.corners.corner_fit import CornerFit, Surroundings, fit_corner
from labcal.detect.corners.corner_kernel import CHESSBOARD, pattern_values
from labcal.detect.corners.corner_model import CornerPixels, linearise
from labcal.detect.corners.corners import Corners, measured_corners
from labcal.detect.corners.local_maps import local_maps
from labcal.detect.corners.uncovered import noise_around, uncovered
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.settings import DetectSettings
from labcal.detect.stage_settings.corner import CornerSettings
from labcal.render.sensor_response import Shot
from labcal.targets.catalogue import load_target
from labcal.targets.charuco import MarkerDictionary, Pattern
from labcal.targets.charuco_opencv import opencv_board

BOARD = load_target("charuco-12x9").model_copy(update={"squares": (7, 5)})
SIZE = (400, 300)
K = np.array([[420.0, 0, 199.5], [0, 424.0, 149.5], [0, 0, 1]])
DIST = np.array([-0.2, 0.05, 0, 0, 0])
FINE, PER_MM, MARGIN = 8, 20, 200
FAR = np.array([99.0, 99.0])  # there are no markers


def pose(about_x: float, about_y: float, about_z: float, distance: float = 210.0) -> np.ndarray:
    """Return ``T_cam_target`` of the board, turned by degrees, its middle on the axis."""
    turns = np.radians([[0, 0, about_z], [about_x, 0, 0], [0, about_y, 0]])
    R = np.diag([1.0, -1.0, -1.0])
    for turn in turns[::-1]:
        R = cv2.Rodrigues(turn)[0] @ R
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = R, np.array([0, 0, distance]) - R @ BOARD.points().mean(axis=0)
    return T


def draw(T: np.ndarray, board=BOARD, noise: float = 2.0, seed: int = 0) -> np.ndarray:  # type: ignore[no-untyped-def]  # noqa: ANN001 - a target
    """Return the picture as floats, white 200 and black 12 where the light is full."""
    across, up = board.squares
    art = opencv_board(board).generateImage((across * 20 * PER_MM, up * 20 * PER_MM))
    art = cv2.copyMakeBorder(art, *[MARGIN] * 4, cv2.BORDER_CONSTANT, value=255).astype(np.float32)
    # Rays of the pixels' centres, one more on each side; between them, places on the board change in a line.
    x, y = (np.arange(-1.0, n + 1.0) for n in SIZE)
    q = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 1, 2)
    rays = cv2.undistortPoints(q, K, DIST, criteria=(3, 20, 1e-10)).reshape(-1, 2)
    on_board = np.linalg.inv(T[:3, [0, 1, 3]]) @ np.concatenate([rays, np.ones((len(rays), 1))], axis=1).T
    places = (on_board[:2] / on_board[2]).reshape(2, SIZE[1] + 2, SIZE[0] + 2)
    # labcal's origin is the lower left inner corner; OpenCV draws from the upper left one of the board.
    column, line = (
        cv2.resize(one.astype(np.float32), None, fx=FINE, fy=FINE)[FINE:-FINE, FINE:-FINE]
        for one in (
            (places[0] + 20.0) * PER_MM - 0.5 + MARGIN,
            ((up - 1) * 20.0 - places[1]) * PER_MM - 0.5 + MARGIN,
        )
    )
    seen = 12 + 188 / 255 * cv2.remap(art, column, line, cv2.INTER_LINEAR, borderMode=cv2.BORDER_REPLICATE)
    x, y = ((np.arange(n * FINE) + 0.5) / FINE - 0.5 for n in SIZE)
    seen *= (1 - 0.15 * (x / SIZE[0] + y[:, None] / SIZE[1])).astype(np.float32)
    # The lens alone blurs, before the pixels: a blur of the artwork is not the same along both axes.
    picture = cv2.GaussianBlur(seen, (0, 0), 0.6 * FINE).astype(np.float64)
    picture = picture.reshape(SIZE[1], FINE, SIZE[0], FINE).mean(axis=(1, 3))
    return picture + np.random.default_rng(seed).normal(0, noise, picture.shape)


def as_bytes(picture: np.ndarray) -> np.ndarray:
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def errors(dots: PictureDots, T: np.ndarray, board=BOARD) -> np.ndarray:  # type: ignore[no-untyped-def]  # noqa: ANN001 - a target
    """Return measured minus true places of the ok corners, by OpenCV's projection."""
    p = board.points(dots.index[dots.ok])
    q, _ = cv2.projectPoints(p, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
    return dots.position[dots.ok] - q.reshape(-1, 2)


def test_normalised_errors_pass_a_chi_square_test() -> None:
    squares, count, rms_opencv = 0.0, 0, []
    for seed, turns in enumerate([(25, -30, 100), (-35, 10, 190), (10, 45, -60)]):
        T = pose(*turns)
        picture = draw(T, seed=seed)
        dots = detect_dots(picture.astype(np.float32), BOARD)
        assert dots.refusal is None
        assert int(dots.ok.sum()) == 24
        assert np.array_equal(dots.index, BOARD.indices())  # all of them, in order
        off = errors(dots, T)
        squares += float(np.einsum("ni,nij,nj->", off, np.linalg.inv(dots.covariance), off))
        count += 2 * len(off)
        assert np.abs(off).max() < 0.05
        opencv = cv2.aruco.CharucoDetector(opencv_board(BOARD)).detectBoard(as_bytes(picture))
        theirs = np.asarray(opencv[0]).reshape(-1, 2)
        p = BOARD.points(BOARD.from_opencv(np.asarray(opencv[1]).ravel()))
        q, _ = cv2.projectPoints(p, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
        rms_opencv.append(float(np.sqrt(((theirs - q.reshape(-1, 2)) ** 2).sum(axis=1).mean())))
        assert np.sqrt((off**2).sum(axis=1).mean()) < 0.5 * rms_opencv[-1]
    assert 0.005 < chi2.sf(squares, count) < 0.995


def test_corners_are_found_from_four_where_rough_places_are_off() -> None:
    """Two markers of a blurred board placed fourteen corners, ten of them so badly that no fit found them."""
    T = pose(25, -30, 10)
    picture = draw(T).astype(np.float32)
    p = BOARD.points()
    q = cv2.projectPoints(p, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)[0].reshape(-1, 2)
    four = [8, 9, 14, 15]
    rough = Corners(BOARD.indices(), q + np.where(np.isin(np.arange(24), four), 0.0, 0.3 * 20.0)[:, None], [])
    some = rough.index[four], rough.seen_at[four]
    for index, seen_at in ((rough.index, rough.seen_at), some):
        given = Corners(index, seen_at, [None] * len(index))
        found = measured_corners(picture, BOARD, given, DetectSettings())
        assert sorted(map(tuple, found.index.tolist())) == sorted(map(tuple, rough.index.tolist()))
        assert all(fit is not None for fit in found.fits)
        true = q[found.index @ [1, BOARD.cols]]
        assert np.abs(found.seen_at - true).max() < 0.2
        assert np.array_equal(found.seen_at, [fit.centre for fit in found.fits if fit is not None])


@pytest.mark.parametrize(
    ("kind", "noise"),
    [
        (PictureKind("grey", bayer=False, jpeg_quality=None), SensorNoise("strong", 2000.0, 60.0)),
        (PictureKind("grey, little noise", bayer=False, jpeg_quality=None), SensorNoise("little", 2e5, 4.0)),
        (PictureKind("grey, JPEG", bayer=False, jpeg_quality=75), SensorNoise("none", 6000.0, None)),
        (PictureKind("Bayer, JPEG", bayer=True, jpeg_quality=95), SensorNoise("usual", 6000.0, 8.0)),
    ],
    ids=lambda one: one.name,
)
def test_stated_errors_are_true_where_tone_mosaic_and_jpeg_are_no_white_noise(
    kind: PictureKind, noise: SensorNoise
) -> None:
    squares = []
    for seed, turns in enumerate([(25, -30, 100), (-35, 10, 190), (10, 45, -60)]):
        T = pose(*turns)
        light = (draw(T, noise=0.0) / 255.0).astype(np.float32)
        for again in range(2):
            dots = detect_dots(taken_picture(light, kind, noise, Shot(seed, kind.name, f"{again}")), BOARD)
            off = errors(dots, T)
            squares.append(np.einsum("ni,nij,nj->n", off, np.linalg.inv(dots.covariance[dots.ok]), off))
    ratio = np.sqrt(np.concatenate(squares).mean() / 2.0)
    assert 0.8 < ratio < 1.25  # 0.3 to 0.65 by the residuals alone, which hold what moves no corner


def test_there_is_no_bias_without_noise() -> None:
    T = pose(20, -25, 40)
    off = errors(detect_dots(draw(T, noise=0.05).astype(np.float32), BOARD), T)
    assert np.abs(off).max() < 0.012  # a bent edge among them
    assert np.abs(off.mean(axis=0)).max() < 0.002


def test_corners_whose_markers_are_hidden_are_found_by_their_neighbours() -> None:
    T = pose(15, 20, 10)
    picture = draw(T)
    hidden = np.zeros(len(BOARD.points()), dtype=bool)
    for k, place in enumerate(BOARD.points()):
        q, _ = cv2.projectPoints(place, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
        x, y = (float(v) for v in q.ravel())
        if k % 6 > 3 and k // 6 > 1:  # cover the corner itself
            cv2.circle(picture, (round(x), round(y)), 7, 90.0, -1)
            hidden[k] = True
        elif k % 6 == 0:  # and spoil the markers of the first column
            cv2.circle(picture, (round(x) - 18, round(y) - 18), 4, 200.0, -1)
            cv2.circle(picture, (round(x) - 18, round(y) + 18), 4, 12.0, -1)
    dots = detect_dots(as_bytes(picture), BOARD)
    assert dots.refusal is None
    seen = {tuple(key) for key in dots.index[dots.ok].tolist()}
    assert seen.isdisjoint({tuple(key) for key in BOARD.indices()[hidden].tolist()})
    assert len(seen) == int((~hidden).sum())
    assert np.abs(errors(dots, T)).max() < 0.1


def test_a_part_of_the_board_is_enough() -> None:
    T = pose(10, -20, 25)
    T[0, 3] += 75.0
    dots = detect_dots(as_bytes(draw(T)), BOARD)
    assert dots.refusal is None
    assert 8 <= int(dots.ok.sum()) < 24
    assert set(dots.flag) <= {DotFlag.OK, DotFlag.CUT}
    assert np.abs(errors(dots, T)).max() < 0.06


def test_legacy_boards_are_told_from_current_ones() -> None:
    legacy = BOARD.model_copy(update={"squares": (7, 4), "pattern": Pattern.LEGACY})
    T = pose(10, 20, 5)
    picture = as_bytes(draw(T, legacy))
    dots = detect_dots(picture, legacy)
    assert int(dots.ok.sum()) == legacy.count
    assert np.abs(errors(dots, T, legacy)).max() < 0.05
    current = legacy.model_copy(update={"pattern": Pattern.CURRENT})
    assert detect_dots(picture, current).refusal is Refusal.OTHER_BOARD


def test_pictures_of_something_else_are_refused() -> None:
    picture = as_bytes(draw(pose(10, 20, 5)))
    others = MarkerDictionary.DICT_4X4_50
    assert detect_dots(picture, BOARD.model_copy(update={"dictionary": others})).refusal is Refusal.NO_MARKERS
    mirrored = np.ascontiguousarray(picture[:, ::-1])
    assert detect_dots(mirrored, BOARD).refusal is Refusal.MIRRORED
    rows = detect_dots(np.ascontiguousarray(picture[:, :130]), BOARD)
    assert rows.refusal in (Refusal.TOO_FEW_DOTS, Refusal.NO_MARKERS)
    assert not rows.has_id.any()


@pytest.mark.parametrize("shape", [(1, 1), (1, 90), (31, 31), (33, 33), (60, 90)])
def test_small_and_empty_pictures_are_refused(shape: tuple[int, int]) -> None:
    noise = np.random.default_rng(1).integers(0, 256, shape).astype(np.uint8)
    for picture in (noise, np.full(shape, 77, np.uint8)):
        dots = detect_dots(picture, BOARD)
        assert dots.refusal is Refusal.NO_MARKERS
        assert dots.size == shape[::-1]


def test_a_corner_that_is_none_is_flagged() -> None:
    T = pose(10, 20, 5)
    picture = as_bytes(draw(T))
    whole = detect_dots(picture, BOARD)
    x, y = (round(float(v)) for v in whole.position[8])
    picture[y - 4 : y + 5, x - 4 : x + 5] = 110
    dots = detect_dots(picture, BOARD)
    at = np.flatnonzero((dots.index == whole.index[8]).all(axis=1))
    assert [dots.flag[k] for k in at] in ([], [DotFlag.BAD_FIT])
    assert int(dots.ok.sum()) == 23


def test_the_blurred_board_is_that_of_the_bivariate_normal_distribution() -> None:
    # Signs of correlated normal variables, by sampling: an independent way to the same figure.
    rng = np.random.default_rng(3)
    u = rng.uniform(-2, 2, (2, 5))
    for correlation in (-0.6, 0.0, 0.4):
        z = rng.multivariate_normal([0, 0], [[1, correlation], [correlation, 1]], 200_000).T
        signs = np.sign(u[:, :, None] + z[:, None, :]).prod(axis=0)
        assert pattern_values(u, correlation, FAR, CHESSBOARD) == pytest.approx(signs.mean(axis=1), abs=0.01)


@pytest.mark.parametrize("correlation", [-0.97, -0.5, 0.0, 0.8, 0.98])
def test_the_blurred_board_is_what_owens_t_gives(correlation: float) -> None:
    u = np.random.default_rng(4).uniform(-6, 6, (2, 400))
    a, b = u
    other = np.sqrt(1 - correlation**2)
    beside = (b - correlation * a) / other / a, (a - correlation * b) / other / b
    expected = 1 - 4 * owens_t(a, beside[0]) - 4 * owens_t(b, beside[1]) - 2 * (a * b < 0)
    np.testing.assert_allclose(pattern_values(u, correlation, FAR, CHESSBOARD), expected, atol=1e-6)


@pytest.mark.parametrize("tone", [0.0, 0.34, -0.2])
def test_derivatives_agree_with_differences(tone: float) -> None:
    rng = np.random.default_rng(0)
    window = CornerPixels(
        np.ones((1, 50), bool),
        rng.normal(size=(2, 50)) * 4,
        rng.normal(size=50),
        np.array([40.0, 50.0]),
        tone=tone,
    )
    state = np.array([0.1, 0.2, 0.3, 1.7, 0.9, 0.7, 100, 80, 0.001, 0.002])
    jacobian = linearise(state, window).jacobian
    for k in range(len(state)):
        step = np.zeros(len(state))
        step[k] = 1e-5 * max(abs(state[k]), 1.0)
        change = linearise(state - step, window).residual - linearise(state + step, window).residual
        assert change / (2 * step[k]) == pytest.approx(jacobian[k], rel=1e-5, abs=1e-5)


def test_a_corner_of_the_wrong_colours_is_none() -> None:
    def fitted(white: int) -> CornerFit | None:
        y, x = np.mgrid[:31, :31] - 15.0
        u = np.stack([(x - 0.3).ravel(), -(y + 0.2).ravel()])
        grey = (100 + 60 * pattern_values(u / 0.8, 0.0, FAR, CHESSBOARD)).reshape(31, 31).astype(np.float32)
        axes = np.array([[30.0, 0.0], [0.0, -30.0]])
        return fit_corner(grey, Surroundings(np.array([15.0, 15.0]), axes, white, 0.4, 9.0), CornerSettings())

    sound = fitted(1)
    assert sound is not None
    assert sound.centre == pytest.approx([15.3, 14.8], abs=2e-3)
    assert fitted(-1) is None


@pytest.mark.parametrize("turn_deg", [0.0, 0.3, 20.0])
def test_corners_of_rasters_without_blur_are_fitted_wherever_they_end_in_a_pixel(turn_deg: float) -> None:
    # The value of a pixel is its covered share; along the rows, an edge touches one pixel in each.
    rng, turn = np.random.default_rng(3), np.radians(turn_deg)
    cos, sin = np.cos(turn), np.sin(turn)
    finer = (np.arange(41 * 12) + 0.5) / 12 - 0.5
    off = []
    for _ in range(12):
        centre = 20.0 + rng.uniform(-0.5, 0.5, 2)
        x, y = np.meshgrid(finer - centre[0], finer - centre[1])
        corner = np.sign(cos * x + sin * y) * np.sign(cos * y - sin * x)
        grey = 128.0 + 120.0 * corner.reshape(41, 12, 41, 12).mean(axis=(1, 3)) + rng.normal(0, 2.5, (41, 41))
        axes = 40.0 * np.array([[cos, -sin], [sin, cos]])
        fit = fit_corner(
            grey.astype(np.float32), Surroundings(centre + 0.3, axes, 1, 0.9, 14.0), CornerSettings()
        )
        assert fit is not None
        off.append(fit.centre - centre)
    # An edge along the rows is known to a part of a pixel only, one that crosses pixels well.
    assert float(np.sqrt(np.square(off).mean())) < (0.1 if turn_deg < 1 else 0.004)


def with_worn_codes(T: np.ndarray, kept: set[int], board=BOARD) -> np.ndarray:  # type: ignore[no-untyped-def]  # noqa: ANN001 - a target
    """Return the picture of a board whose codes are rubbed to an even grey, but for some."""
    picture, half = draw(T, board), 0.36 * board.marker_mm
    places = opencv_board(board).getObjPoints()
    for number, corners in enumerate(places):
        if number in kept:
            continue
        middle = board.points_from_opencv(np.asarray(corners, dtype=np.float64)).mean(axis=0)
        square = middle + half * np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
        q, _ = cv2.projectPoints(square, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
        cv2.fillConvexPoly(picture, np.round(q[:, 0] * 16).astype(np.int32), 110.0, cv2.LINE_AA, 4)
    return as_bytes(picture)


@pytest.mark.parametrize("kept", [{0, 5, 11, 16}, {1, 8, 9, 14}, {2, 13}])
def test_a_few_markers_that_no_corner_has_two_of_place_the_whole_board(kept: set[int]) -> None:
    T = pose(24, -18, 130)
    picture = with_worn_codes(T, kept)
    read = cv2.aruco.CharucoDetector(opencv_board(BOARD)).detectBoard(picture)
    assert set(read[3].ravel().tolist()) == kept  # OpenCV reads no other one
    dots = detect_dots(picture, BOARD)
    assert np.array_equal(dots.index[dots.ok], BOARD.indices())
    assert np.abs(errors(dots, T)).max() < 0.06


def test_a_single_marker_places_no_board_and_is_told_so() -> None:
    dots = detect_dots(with_worn_codes(pose(10, 15, 20), {7}), BOARD)
    assert dots.refusal is Refusal.MARKERS_UNREADABLE
    assert dots.why.startswith("1 marker of the board's 17 was read. Two markers or more")
    assert not dots.has_id.any()


def test_boards_may_begin_with_any_marker() -> None:
    board = BOARD.model_copy(update={"first_id": 31})
    T = pose(-20, 25, 75)
    picture = as_bytes(draw(T, board))
    dots = detect_dots(picture, board)
    assert np.array_equal(dots.index[dots.ok], BOARD.indices())
    assert np.abs(errors(dots, T)).max() < 0.06
    other = detect_dots(picture, BOARD)
    assert other.refusal is Refusal.OTHER_IDS
    assert other.why.startswith("Markers 31 to 4")
    assert "of DICT_5X5_100 were read; the target has 0 to 16." in other.why
    assert "first_id: 31" in other.why
    # Half of the ids are those of the target, on squares of which it has other ones.
    near = detect_dots(picture, BOARD.model_copy(update={"first_id": 24}))
    assert near.refusal is Refusal.OTHER_IDS
    assert "first_id: 31" in near.why


def test_boards_of_another_number_of_squares_are_not_numbered_by_the_rows_that_agree() -> None:
    """Rows of an odd board in the other pattern agree with the target's, moved by a square, but for one."""
    shown = BOARD.model_copy(update={"squares": (7, 4), "pattern": Pattern.LEGACY})
    for squares in ((7, 4), (6, 5), (8, 4), (5, 7)):
        named = BOARD.model_copy(update={"squares": squares})
        dots = detect_dots(as_bytes(draw(pose(15, -10, 40), shown)), named)
        assert dots.refusal in (Refusal.OTHER_BOARD, Refusal.OTHER_IDS)
        assert not dots.has_id.any()


def test_corners_that_are_covered_are_told_from_a_board_that_is_not_in_the_frame() -> None:
    T = pose(10, 5, 15)
    picture = draw(T)
    q, _ = cv2.projectPoints(BOARD.points(), cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
    for x, y in q[:, 0]:
        cv2.circle(picture, (round(float(x)), round(float(y))), 5, 120.0, -1)
    torn = detect_dots(as_bytes(picture), BOARD)
    assert torn.refusal is Refusal.TORN_CORNERS
    assert "24 of the board's 24 corners were placed by 17 markers, 0 measured." in torn.why
    cut = detect_dots(np.ascontiguousarray(as_bytes(draw(T))[:, :128]), BOARD)
    assert cut.refusal is Refusal.TOO_FEW_DOTS


def test_markers_that_a_program_rounds_to_pixels_do_not_move_corners() -> None:
    """OpenCV draws the cells of 5 x 5 markers up to one pixel of its picture off."""
    T = pose(25, -30, 100)
    off = errors(detect_dots(draw(T, seed=3).astype(np.float32), BOARD), T)
    assert np.sqrt((off**2).mean()) < 0.005  # 0.02 with cells where they should be


def test_maps_around_corners_follow_a_lens_and_perspective() -> None:
    T = pose(-35, 10, 190)
    p = BOARD.points()
    q, _ = cv2.projectPoints(p, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
    nodes = [(int(i), int(j)) for i, j in BOARD.indices()]
    maps = local_maps(nodes, q.reshape(-1, 2), np.full(len(p), 0.01), SIZE)
    assert maps.known.all()
    for k, node in enumerate(nodes):
        away = 0.3 * BOARD.square_mm * np.array([1.0, -1.0, 0.0])
        beside, _ = cv2.projectPoints(p[k] + away, cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], K, DIST)
        x, y = beside.ravel() - q.reshape(-1, 2)[k]
        r = np.array([x, y])
        square = np.array([0.5 * x * x, x * y, 0.5 * y * y])
        cube = np.array([x**3 / 6.0, 0.5 * x * x * y, 0.5 * x * y * y, y**3 / 6.0])
        step = maps.linear[k] @ r / (1.0 + maps.perspective[k] @ r)
        step = step + maps.square[k] @ square + maps.cube[k] @ cube
        at_rim = node[0] in (0, 5) or node[1] in (0, 3)
        # At the rim they are extrapolated; bends on the board, which is tilted, leave 2.5e-4 further in.
        assert np.abs(step - [0.3, -0.3]).max() < (0.004 if at_rim else 1e-4), node


def test_pixels_that_something_covers_are_left_out_and_no_others() -> None:
    mask = np.hypot(*(np.mgrid[:41, :41] - 20.0)) < 20.0
    residual = np.random.default_rng(0).normal(0.0, 2.0, mask.shape)
    noise = np.full(mask.sum(), 2.0)
    assert uncovered(mask, residual[mask], noise, 0.8).all()
    residual[:, 30:] += 9.0
    columns = np.broadcast_to(np.arange(41), mask.shape)[mask]
    seen = uncovered(mask, residual[mask], noise, 0.8)
    assert not seen[columns >= 29].any()  # what is covered, and its blurred edge
    assert seen[columns < 22].all()


def test_white_pixels_in_bright_light_are_not_taken_for_covered() -> None:
    # Photon noise of white is larger than the usual noise of pixels black and white.
    mask = np.hypot(*(np.mgrid[:41, :41] - 20.0)) < 20.0
    white = (np.mgrid[:41, :41] < 20).any(axis=0)
    residual = np.where(white, 4.5, 1.0) * np.random.default_rng(0).normal(size=mask.shape)
    pattern = np.where(white, 1.0, -1.0)[mask]
    noise = noise_around(residual[mask], pattern, 2.0)
    assert np.abs(noise - np.where(pattern > 0.0, 4.5, 2.0)).max() < 0.5
    assert uncovered(mask, residual[mask], noise, 0.8).all()
    residual[:, 33:] -= 25.0
    columns = np.broadcast_to(np.arange(41), mask.shape)[mask]
    seen = uncovered(mask, residual[mask], noise_around(residual[mask], pattern, 2.0), 0.8)
    assert not seen[columns >= 32].any()
    assert seen[columns < 25].all()


def test_corners_of_a_view_are_not_off_together_where_a_tone_curve_is_no_root() -> None:
    target = load_target("charuco-12x9")
    random = np.random.default_rng(2)
    drawn = DrawnViews.of(target, board_poses(target, 5, random), random)
    dots, together = drawn.detections, []
    for name, number in drawn.names.items():
        for which, camera in enumerate(("left", "right")):
            some = dots.where(dots.ok & (dots.view == name) & (dots.camera == camera))
            true = drawn.true_px[number, which, some.index[:, 1] * target.cols + some.index[:, 0]]
            weight = np.linalg.inv(some.covariance)
            mean = np.linalg.solve(
                weight.sum(axis=0), (weight @ (some.position - true)[..., None]).sum(axis=0)
            )
            together.append(float(mean[:, 0] @ weight.sum(axis=0) @ mean[:, 0]))
    assert chi2.sf(sum(together), 2 * len(together)) > 1e-3
