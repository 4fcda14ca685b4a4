"""Each mistake has the size that it is said to have."""

import numpy as np
import pytest

from labcal.errors import UnknownNameError
from labcal.paper.explanations.board_problem import BoardProblem
from labcal.paper.explanations.causes import CAUSES, cause_named
from labcal.paper.problem import Problem

NAMES = [cause.name for cause in CAUSES]


def disturbed(board: BoardProblem, name: str, size: float) -> Problem:
    return cause_named(name).disturbed(board, size, np.random.default_rng(0))


@pytest.mark.parametrize("name", NAMES)
def test_a_mistake_of_size_zero_changes_nothing_and_sizes_share_their_random_numbers(
    board: BoardProblem, name: str
) -> None:
    none, one, two = (disturbed(board, name, size) for size in (0.0, 0.01, 0.02))
    for field in ("X", "Y", "X_test", "Y_test"):
        given = getattr(board.problem, field)
        np.testing.assert_allclose(getattr(none, field), given, atol=1e-9)
        np.testing.assert_allclose(
            getattr(two, field) - given, 2 * (getattr(one, field) - given), atol=2e-6
        )  # linear in the size


def test_noise_has_its_standard_deviation(board: BoardProblem) -> None:
    """The sum of n squared standard normals is chi-squared: mean n, standard deviation sqrt(2 n)."""
    for name, field, columns in (
        ("points picked by hand", "X", 4), ("points picked by hand", "X_test", 4),
        ("places by ruler, independent", "Y", 2), ("places by ruler, independent", "Y_test", 2),
    ):  # fmt: skip
        noise = (getattr(disturbed(board, name, 3.0), field) - getattr(board.problem, field)) / 3.0
        n = len(noise) * columns
        assert abs((noise**2).sum() - n) < 4 * np.sqrt(2 * n)
        assert not noise[:, columns:].any()


def test_a_wrong_scale_lengthens_the_board(board: BoardProblem) -> None:
    Y = disturbed(board, "places by ruler, scale", 7.0).Y
    assert np.ptp(Y[:, 0]) == pytest.approx(707.0)
    assert np.ptp(Y[:, 1]) == pytest.approx(707.0)
    assert Y[:, :2].min() == pytest.approx(650.0)


def test_the_corners_of_a_bent_board_are_seen_raised(board: BoardProblem) -> None:
    X = disturbed(board, "bent board", 5.0).X
    corner = board.world[0] + np.array([0.0, 0.0, 5.0])
    expected = np.concatenate([camera.project(corner).q for camera in board.cameras])
    np.testing.assert_allclose(X[0], expected, atol=1e-9)


def test_a_displaced_origin_is_the_mean_signed_error(board: BoardProblem) -> None:
    Y_test = disturbed(board, "displaced origin", 12.0).Y_test
    np.testing.assert_allclose(Y_test - board.problem.Y_test, 12.0)


def test_lengths_of_the_experiment(board: BoardProblem) -> None:
    """A focal length of 1800 px at 1.74 m sees 0.97 mm in a pixel across the view."""
    np.testing.assert_allclose(board.lengths_mm, 700.0)
    assert board.camera_distance_mm == pytest.approx(1736.0, rel=0.01)
    across = board.camera_distance_mm / 1803.0
    assert across < board.pixel_mm < 1.1 * across  # slanted lengths are foreshortened


def test_a_cause_that_is_not_there() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'bent board'"):
        cause_named("bend board")
