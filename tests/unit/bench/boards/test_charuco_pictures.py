"""Drawn pictures of ChArUco boards against analytic edges, and their bound against derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import ndtr

from labcal.bench.boards.board_checks import board_checks
from labcal.bench.boards.cell_print import cell_ink
from labcal.bench.boards.charuco_ink import charuco_ink
from labcal.bench.boards.charuco_picture import COARSE, FINE, charuco_picture
from labcal.bench.boards.charucos import EDGES, charuco_outcome
from labcal.bench.boards.corner_bound import ImagedCorner, corner_bounds
from labcal.bench.boards.printed_corner_bound import PrintedCorner, printed_corner_bounds, printed_share
from labcal.bench.marks.drawn_picture import INK, PAPER, Cover, Exposure, drawn
from labcal.targets.charuco_opencv import markers

AXES = np.array([[21.0, 4.0], [-3.0, 19.0]])


def chessboard(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    return cell_ink(np.array([-3.0, 0.0, 3.0]), np.array([-3.0, 0.0, 3.0]), _SQUARES)(x, y)


_SQUARES = np.array([[0, 0, 0, 0], [0, 0, 1, 0], [0, 1, 0, 0], [0, 0, 0, 0]], dtype=np.float64)


@pytest.mark.parametrize("turn_deg", [0.0, 17.0])
def test_the_drawing_of_an_edge_is_the_blurred_step(turn_deg: float) -> None:
    half_plane = cell_ink(np.array([0.0, 50.0]), np.array([-50.0, 50.0]), np.tile([0.0, 1.0, 1.0], (3, 1)))
    turn, blur = np.radians(turn_deg), 0.9
    R = np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    shift = np.array([19.37, 15.2])
    H = np.eye(3)
    H[:2, :2], H[:2, 2] = R.T, shift
    exposure = Exposure((40, 30), H, blur, np.zeros(2), 0.0)
    picture = drawn(exposure, half_plane, (), np.random.default_rng(0)).astype(np.float64)
    y, x = np.mgrid[:30, :40]
    distance = (np.stack([x, y], axis=-1) - shift) @ R[0]
    # A pixel's own width is close to a Gaussian of variance 1/12.
    expected = 255.0 * (PAPER + (INK - PAPER) * ndtr(distance / np.sqrt(blur**2 + 1.0 / 12.0)))
    assert np.abs(picture - expected).max() < 1.0  # half a level is rounding


@pytest.mark.parametrize("board", [COARSE, FINE], ids=lambda one: one.name)
def test_the_ink_of_a_board_is_that_of_its_squares_and_markers(board) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001 - a target
    step = 0.02  # samples are small beside cells
    x, y = np.meshgrid(*(step * (np.arange(round(n / step)) + 0.5) - 1.0 for n in board.squares))
    is_ink = charuco_ink(board)(x, y) > 0.5

    def at(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        col, row = (np.floor((place + 1.0) / step).astype(int) for place in (x, y))
        return np.asarray(is_ink[row, col])

    i, j = np.indices(board.squares)
    # Near the lower left corner of a square there is white paper where there is a marker.
    assert np.array_equal(at(i - 0.95, j - 0.95), board.is_black(i, j))
    printed = markers(board)
    cells = printed.is_black.shape[1]
    a, b = (np.indices((cells, cells)) + 0.5) * board.marker_mm / cells
    for corner, black in list(zip(printed.corner, printed.is_black, strict=True))[::7]:
        assert np.array_equal(at(corner[0] + a, corner[1] + b), black[::-1].T)


def test_the_bound_of_a_print_without_markers_is_that_of_a_chessboard() -> None:
    centre, noises = np.array([40.3, 31.8]), np.array([[0.02, 0.02], [0.01, 0.03]])
    printed = printed_corner_bounds(PrintedCorner(centre, AXES, 1.1, INK, PAPER, chessboard), noises)
    plain = corner_bounds(ImagedCorner(centre, AXES, 1.1, INK, PAPER), noises)
    assert printed == pytest.approx(plain, rel=0.01, abs=1e-9)


def test_what_is_covered_does_not_tell_of_a_corner() -> None:
    centre, noises = np.array([40.3, 31.8]), np.array([[0.02, 0.02]])

    def trace(*covers: Cover) -> float:
        imaged = PrintedCorner(centre, AXES, 1.1, INK, PAPER, chessboard, covers)
        return float(np.trace(printed_corner_bounds(imaged, noises)[0]))

    size, along = np.array([10.0, 10.0]), AXES[:, 0] / np.linalg.norm(AXES[:, 0])
    away = Cover(centre + 90.0, size, 0.0, 0.1)
    over_an_edge = Cover(centre + 18.0 * along, size, float(np.arctan2(along[1], along[0])), 0.1)
    assert trace(away) == trace()
    assert 1.2 * trace() < trace(over_an_edge) < 4.0 * trace()


def test_the_bound_is_what_the_derivatives_of_a_drawing_give() -> None:
    # Two parameters alone, the place: an upper bound of the information, by drawings of the whole print.
    board = COARSE
    ink = charuco_ink(board)
    blur, noise, step = 1.0, 0.02, 0.05
    H = np.eye(3)
    H[:2, :2], H[:2, 2] = AXES, [8.0, 9.0]
    corner = Exposure((60, 50), H, blur, np.zeros(2), 0.0).seen(np.array([[1.0, 1.0]]))[0]

    def local(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        return ink(x + 1.0, y + 1.0)

    imaged = PrintedCorner(corner, AXES, blur, INK, PAPER, local)
    full = printed_corner_bounds(imaged, np.array([[noise, noise]]))[0]
    angles = np.arctan2(AXES[1], AXES[0])
    slopes = []
    for axis in range(2):
        by = step * np.eye(2)[axis]
        up, down = (
            printed_share(imaged, np.array([*(corner + sign * by), *angles, blur]), (60, 50))
            for sign in (1, -1)
        )
        slopes.append((INK - PAPER) * (up - down) / (2.0 * step))
    y, x = np.mgrid[:50, :60]
    along = np.linalg.inv(AXES) @ (np.stack([x, y]).reshape(2, -1) - corner[:, None])
    D = np.stack(slopes).reshape(2, -1)[:, np.abs(along).max(axis=0) <= 0.5]
    place_alone = np.linalg.inv(D @ D.T) * noise**2
    # What else is unknown costs something, but no more than it does on a chessboard.
    ratio = np.sqrt(np.trace(full) / np.trace(place_alone))
    assert 1.0 <= ratio < 1.6
    edges = corner_bounds(ImagedCorner(corner, AXES, blur, INK, PAPER), np.array([[noise, noise]]))[0]
    assert np.trace(full) < np.trace(edges)  # the markers' edges tell of the place, too


def test_a_picture_of_a_board_is_measured_and_its_checks_have_names() -> None:
    picture = charuco_picture(1, 3)
    assert picture.board is FINE
    assert picture.countable
    outcome = charuco_outcome(picture, np.random.default_rng(0))
    assert outcome.indexed
    assert outcome.wrong == 0
    assert len(outcome.error) == 10
    names = [check.name for check in board_checks("one", [outcome], EDGES).checks]
    assert names[:2] == ["one: share not indexed", "one: wrong ids"]
    assert sum("detectBoard" in name for name in names) == 2
    lost = replace(outcome, indexed=False)
    assert board_checks("hundred", [outcome] * 99 + [lost], EDGES).checks[0].ok  # one of a hundred is granted
    assert not board_checks("hundred", [outcome] * 98 + [lost] * 2, EDGES).checks[0].ok
