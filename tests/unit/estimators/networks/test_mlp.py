from collections.abc import Callable
from statistics import median

import numpy as np
import pytest
import torch
from sklearn.base import clone

from labcal.errors import InputError
from labcal.estimators.networks.mlp import Mlp

View = Callable[[np.ndarray], np.ndarray]


def test_a_plane_reaches_the_papers_goals_in_about_its_epochs(
    stereo: View, plane: np.ndarray, other_plane: np.ndarray
) -> None:
    # Rows 02 and 09: 9 epochs to 1e-7, 12 to 1e-8.
    runs = [Mlp(goal=1e-8, random_state=seed).fit(stereo(plane), plane) for seed in range(5)]
    assert all(run.stop_reason_ == "goal reached" and run.mse_ <= 1e-8 for run in runs)
    assert 6 <= median(run.n_iter_ for run in runs) <= 24
    to_first = [int(np.argmax(run.history_ <= 1e-7)) for run in runs]
    assert 4.5 <= median(to_first) <= 18
    signed = [float(np.mean(run.predict(stereo(other_plane)) - other_plane)) for run in runs]
    assert median(map(abs, signed)) < 0.1


def test_mse_is_over_all_scaled_outputs_and_the_constant_one_counts(stereo: View, plane: np.ndarray) -> None:
    fitted = Mlp(goal=1e-5, max_epochs=50).fit(stereo(plane), plane)
    errors = (fitted.predict(stereo(plane)) - plane) / np.array([350.0, 350.0, 1.0])
    assert fitted.mse_ == pytest.approx(float(np.mean(errors**2)), rel=1e-6)
    assert fitted.history_[-1] == fitted.mse_
    assert len(fitted.history_) == fitted.n_iter_ + 1


def test_a_volume_is_learned_with_further_outputs(stereo: View, volume: np.ndarray) -> None:
    Y = np.column_stack((volume, np.linalg.norm(volume, axis=1)))
    fitted = Mlp(hidden=(50,), goal=1e-5, max_epochs=60).fit(stereo(volume), Y)
    assert fitted.stop_reason_ == "goal reached"
    assert fitted.predict(stereo(volume)).shape == (300, 4)


def test_not_reaching_the_goal_is_a_result(stereo: View, volume: np.ndarray) -> None:
    fitted = Mlp(goal=1e-12, max_epochs=3).fit(stereo(volume), volume)
    assert (fitted.stop_reason_, fitted.n_iter_) == ("epochs exhausted", 3)


def test_without_hidden_layers_it_is_the_affine_regression(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    terms = np.column_stack((np.ones(300), X))
    expected = terms @ np.linalg.lstsq(terms, volume)[0]
    np.testing.assert_allclose(
        Mlp(hidden=(), goal=0.0, max_epochs=40).fit(X, volume).predict(X), expected, atol=1e-5
    )


def test_same_seed_same_bytes_whatever_the_number_of_threads(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    before = torch.get_num_threads()
    try:
        predictions = []
        for threads in (1, 2):
            torch.set_num_threads(threads)
            predictions.append(Mlp(goal=1e-6, max_epochs=8, random_state=3).fit(X, volume).predict(X))
            assert torch.get_num_threads() == threads
    finally:
        torch.set_num_threads(before)
    assert predictions[0].tobytes() == predictions[1].tobytes()
    other = Mlp(goal=1e-6, max_epochs=8, random_state=4).fit(X, volume).predict(X)
    assert predictions[0].tobytes() != other.tobytes()


def test_fitting_leaves_global_random_states_alone(stereo: View, plane: np.ndarray) -> None:
    before = torch.get_rng_state()
    Mlp(max_epochs=1).fit(stereo(plane), plane)
    assert torch.equal(before, torch.get_rng_state())


def test_constant_inputs_do_no_harm(stereo: View, plane: np.ndarray) -> None:
    X = stereo(plane)
    X[:, 3] = 7.0
    assert Mlp(goal=1e-6, max_epochs=40).fit(X, plane).stop_reason_ == "goal reached"


def mean_squares(fitted: Mlp, X: np.ndarray, Y: np.ndarray) -> np.ndarray:
    """Return every member's mean squared error over scaled outputs."""
    errors = (fitted._predictions(X) - Y) / fitted.output_half_range_
    return np.asarray((errors**2).mean(axis=(1, 2)))


def test_of_restarts_the_best_is_kept(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    # The members of an ensemble have the same starts, and all go to their end; so soon, none is given up.
    each = Mlp(hidden=(8,), goal=0.0, max_epochs=4, members=4, random_state=0).fit(X, volume)
    squares = mean_squares(each, X, volume)
    best = Mlp(hidden=(8,), goal=0.0, max_epochs=4, restarts=4, random_state=0).fit(X, volume)
    assert best.parameters_.shape[0] == 1
    assert best.mse_ == pytest.approx(squares.min(), rel=1e-9)
    assert squares[0] > 1.5 * best.mse_
    two = Mlp(hidden=(8,), goal=0.0, max_epochs=4, members=2, restarts=2, random_state=0).fit(X, volume)
    numbers = np.sort(np.argsort(squares)[:2])
    np.testing.assert_allclose(two.parameters_, each.parameters_[numbers], rtol=1e-6, atol=1e-9)


def test_a_race_of_restarts_ends_where_one_of_them_would_alone(stereo: View, volume: np.ndarray) -> None:
    X = stereo(volume)
    each = Mlp(hidden=(20,), goal=0.0, max_epochs=40, members=3, random_state=3).fit(X, volume)
    squares = mean_squares(each, X, volume)
    raced = Mlp(hidden=(20,), goal=0.0, max_epochs=40, restarts=3, random_state=3).fit(X, volume)
    assert raced.mse_ < squares.max()
    assert np.abs(squares / raced.mse_ - 1).argmin() == squares.argmin() == 2
    assert raced.mse_ == pytest.approx(squares.min(), rel=1e-3)
    assert (raced.n_iter_, raced.stop_reason_) == (40, "epochs exhausted")


def test_clone_keeps_the_parameters() -> None:
    copy = clone(Mlp(hidden=(55,), goal=1e-5, max_epochs=7, random_state=9))
    assert copy.get_params() == {
        "hidden": (55,), "goal": 1e-5, "max_epochs": 7, "members": 1, "restarts": 1, "random_state": 9,
    }  # fmt: skip


def test_bad_input_is_refused(stereo: View, plane: np.ndarray) -> None:
    with pytest.raises(InputError, match="must not be negative"):
        Mlp(goal=-1.0).fit(stereo(plane), plane)
    with pytest.raises(InputError, match="mlp: restarts must be 1 or more, but is 0"):
        Mlp(restarts=0).fit(stereo(plane), plane)
    with pytest.raises(InputError, match="no empty layer"):
        Mlp(hidden=(20, 0)).fit(stereo(plane), plane)
    with pytest.raises(InputError, match="NaN"):
        Mlp().fit(np.where(np.eye(300, 4) == 1, np.nan, stereo(plane)), plane)
    with pytest.raises(InputError, match="minimum of 2"):
        Mlp().fit(stereo(plane[:1]), plane[:1])
