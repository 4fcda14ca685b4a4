"""Points of damaged models, which are signed anew so that only their numbers tell."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal.correspond.matching import Matches
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import load_model, save_model
from labcal.estimators.registry import make_estimator
from labcal.estimators.stored_estimator import _like
from labcal.estimators.valid_points import predicted, within_sense

View = Callable[[np.ndarray], np.ndarray]


@pytest.fixture
def model(stereo: View, volume: np.ndarray) -> Model:
    estimator = make_estimator("dlt").fit(stereo(volume), volume)
    sizes = ((640, 480), (640, 480))
    return Model(estimator, ("left", "right"), sizes, TrainingBox.of(stereo(volume), volume))


def reloaded(model: Model, tmp_path: Path) -> Model:
    save_model(tmp_path / "m.safetensors", model, force=True)
    return load_model(tmp_path / "m.safetensors")


@pytest.mark.parametrize("value", [1e200, -1e308])
def test_numbers_beyond_sense_are_refused(
    value: float, model: Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    box = replace(model.box, high_mm=np.array([1.0, 1.0, value]))
    with pytest.raises(InputError, match=r"volume in which the model|holds a number beyond"):
        reloaded(replace(model, box=box), tmp_path)
    # As a program without the checks of writing would write it, digest and all.
    arrays = {"projections_": np.full((2, 3, 4), value)}
    monkeypatch.setattr("labcal.estimators.model_file.stored_arrays", lambda _: dict(arrays))
    with pytest.raises(InputError, match=r"holds a number beyond 1e\+60"):
        reloaded(model, tmp_path)


@pytest.mark.parametrize("value", [1e200, np.nan])
def test_numbers_beyond_sense_are_not_written(value: float, model: Model, tmp_path: Path) -> None:
    model.estimator.projections_ = np.full((2, 3, 4), value)
    with pytest.raises(InputError, match=r"It should be finite float64, up to 1e\+60"):
        save_model(tmp_path / "n.safetensors", model)
    assert list(tmp_path.iterdir()) == []


def test_a_box_that_is_upside_down_is_refused(model: Model, tmp_path: Path) -> None:
    box = replace(model.box, low_mm=model.box.high_mm, high_mm=model.box.low_mm)
    with pytest.raises(InputError, match="volume in which the model"):
        reloaded(replace(model, box=box), tmp_path)


@pytest.mark.parametrize(
    ("value", "default", "like"),
    [
        (3, 5, True), (True, 5, False), (-1, 5, False), (10**30, 5, False), (2.5, 5, False), ("3", 5, False),
        (2, 0.5, True), (1e200, 0.5, False), (-0.5, 0.5, False), ("auto", "auto", True), (1, "auto", False),
        ((4, 5), (20, 30), True), ((0,), (20, 30), False), ("abc", (20,), False),
        (None, None, True), (((640, 480),), None, True), (((640, -480),), None, False),
    ],
)  # fmt: skip
def test_parameters_are_of_their_defaults_kind(value: object, default: object, *, like: bool) -> None:
    assert _like(value, default) is like


def test_what_cannot_be_computed_is_told_as_the_models_fault(model: Model, stereo: View) -> None:
    X = stereo(np.array([[1000.0, 1000.0, 500.0]]))
    matches = Matches(
        ("left", "right"), np.array(["v"]), np.zeros((1, 2), dtype=np.int64), X.reshape(1, 2, 2),
        np.tile(np.eye(2), (1, 2, 1, 1)),
    )  # fmt: skip
    model.estimator.projections_ = np.full((2, 3, 4), np.inf)
    with pytest.raises(InputError, match="its numbers are damaged"):
        predicted(model, matches)


def test_points_that_are_nowhere_have_no_solution() -> None:
    n = 3
    points = Points(
        np.array(["v"] * n), np.zeros((n, 2), dtype=np.int64),
        np.array([[1.0, 2.0, 3.0], [0.0, 0.0, 1e200], [1.0, 2.0, 3.0]]),
        np.stack([np.eye(3), np.eye(3), np.diag([1.0, 1.0, -1.0])]), np.array(["ok"] * n, dtype="<U16"),
    )  # fmt: skip
    found = within_sense(points)
    assert found.flag.tolist() == ["ok", "no-solution", "ok"]
    assert np.isnan(found.point[1]).all()
    assert np.isnan(found.covariance).all(axis=(1, 2)).tolist() == [False, True, True]
    sound = points.where(np.array([True, False, False]))
    assert within_sense(sound) is sound
