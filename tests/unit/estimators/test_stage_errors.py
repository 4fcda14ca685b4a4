"""Errors of a stage, against cameras that are fitted to readings which are drawn anew each time."""

import inspect
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from scipy import stats

from labcal import InputError, Model, examples, load_target, pipeline
from labcal.calibrate.resection.placed import PlacedCamera
from labcal.calibrate.resection.resected import NEAR, adjusted
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches
from labcal.correspond.training import TrainingData
from labcal.estimators import training as of_dots
from labcal.estimators.centred_training import CentredTraining
from labcal.estimators.stage_errors import StageErrors, StageSigma, stage_errors
from labcal.estimators.valid_points import predicted
from labcal.geometry.poses import from_rotation_vector, pose, transform
from labcal.optim.whitening import UniformNoise
from labcal.pipeline import FitSettings
from labcal.report.fit_result import FitResult, fit_table

SIGMA, DRAWS = StageSigma(0.05, 0.02), 48
PLACES = {f"v{number}": (-60.0, -40.0, 560.0 + 25.0 * number) for number in range(5)}
BOARD = np.array([[20.0 * col, 20.0 * row, 0.0] for row in range(5) for col in range(7)])


def cameras() -> tuple[Camera, ...]:
    K = [[900.0, 0.0, 320.0], [0.0, 905.0, 240.0], [0.0, 0.0, 1.0]]
    turned = from_rotation_vector(np.array([0.0, 0.3, 0.0]), np.array([-180.0, 3.0, 25.0]))
    moved = from_rotation_vector(np.array([0.02, -0.01, 0.01]), np.array([1.0, 2.0, 3.0]))
    return tuple(Camera(K, "brown-k1k2", [-0.1, 0.05, 0, 0, 0], T, (640, 480)) for T in (moved, turned))


def training(read: dict[str, np.ndarray]) -> TrainingData:
    """Return exact pixels of the target where it truly is, and its places by readings of a stage."""
    true = {view: pose(np.eye(3), np.array(place)) for view, place in PLACES.items()}
    X = [np.concatenate([camera.project(transform(T, BOARD)).q for camera in cameras()], 1)
         for T in true.values()]  # fmt: skip
    Y = [transform(read.get(view, true[view]), BOARD) for view in PLACES]
    index = np.array([[col, row] for row in range(5) for col in range(7)] * len(PLACES))
    view = np.repeat(list(PLACES), len(BOARD))
    sizes = ((640, 480), (640, 480))
    return TrainingData(("left", "right"), sizes, view, index, np.concatenate(X), np.concatenate(Y))


def poses() -> dict[str, np.ndarray]:
    return {view: pose(np.eye(3), np.array(place)) for view, place in PLACES.items()}


def test_points_scatter_as_the_errors_of_the_stage_tell() -> None:
    """Cameras that are fitted to false readings place points as far off as the share states."""
    rng, exact, errors = np.random.default_rng(4), training({}), []
    p = np.array([[0.0, 0.0, 600.0], [-40.0, 20.0, 570.0], [50.0, -30.0, 650.0]])
    q = np.stack([camera.project(p).q for camera in cameras()], axis=1)
    noise = np.tile(np.eye(2), (len(p), 2, 1, 1))
    for _ in range(DRAWS):
        read = {}
        for view, T in poses().items():
            turn = np.radians(SIGMA.deg) * rng.standard_normal(3)
            off = from_rotation_vector(turn, np.zeros(3))[:3, :3]
            read[view] = pose(off @ T[:3, :3], T[:3, 3] + SIGMA.mm * rng.standard_normal(3))
        data = training(read)
        fitted = [
            adjusted(
                PlacedCamera(camera, data.Y.mean(axis=0)), data.X[:, 2 * number : 2 * number + 2], data.Y,
                UniformNoise(1.0), NEAR,
            ).camera
            for number, camera in enumerate(cameras())
        ]  # fmt: skip
        errors.append(triangulate(fitted, q, noise).point - p)
    stated = stage_errors(cameras(), exact, poses(), SIGMA).share(cameras(), p, noise)
    low, high = stats.chi2.ppf([5e-4, 0.9995], 3 * DRAWS)
    for row in range(len(p)):
        off = np.array(errors)[:, row]
        assert low < np.einsum("di,ij,dj->", off, np.linalg.inv(stated[row]), off) < high, row


def fitted() -> Model:
    quick = FitSettings(lens="brown5", rehearsal=False)
    return pipeline.fit(examples.TARGET, examples.detections(), "dlt", quick)


def test_a_model_keeps_them_and_its_points_hold_them(tmp_path: Path) -> None:
    plain = replace(fitted(), covariance=None)
    assert plain.resected is not None
    size = sum(4 + camera.model.coefficients + 6 for camera in plain.resected)
    lower = tuple(tuple(float(i == k) * 1e-6 for k in range(i + 1)) for i in range(size))
    model = replace(plain, stage=StageErrors(sigma_mm=0.01, sigma_deg=0.005, lower=lower))
    model.save(tmp_path / "model")
    again = Model.load(tmp_path / "model")
    assert again == model != plain
    q = np.tile([[320.0, 240.0], [310.0, 240.0]], (2, 1, 1))
    covariance = np.tile(1e-3 * np.eye(2), (2, 2, 1, 1))
    matches = Matches(model.cameras, np.array(["v", "v"]), np.zeros((2, 2), dtype=np.int64), q, covariance)
    with_stage, without = predicted(again, matches)[1], predicted(plain, matches)[1]
    assert (np.linalg.eigvalsh(with_stage - without) > 0.0).all()
    with pytest.raises(InputError, match="the errors of its stage differ"):
        replace(plain, stage=StageErrors(sigma_mm=0.01, sigma_deg=0.0, lower=((1.0,),)))
    with pytest.raises(ValueError, match="negative variance"):
        StageErrors(sigma_mm=0.01, sigma_deg=0.0, lower=((-1.0,),))


def test_they_are_of_a_stage_alone() -> None:
    settings = FitSettings(lens="brown5", stage_sigma_mm=0.01)
    with pytest.raises(InputError, match="this one was held in the hand"):
        pipeline.training_of(load_target(examples.TARGET), examples.detections(), settings)
    with pytest.raises(InputError, match="`stage_sigma_deg` must be a number from 0 to 10"):
        FitSettings(stage_sigma_deg=-1.0)
    assert FitSettings(stage_sigma_mm=0.01).stage_sigma == StageSigma(0.01, 0.0)


def test_fit_says_whether_sigmas_hold_them() -> None:
    plain = FitResult([], None, None, None, [], [], [])
    assert "errors of the stage are in no sigma" in str(fit_table(plain, rehearsed=False).caption)
    stated = replace(plain, stage=StageSigma(0.01, 0.005))
    assert "(0.01 mm, 0.005 deg)" in str(fit_table(stated, rehearsed=False).caption)


def test_the_field_of_hybrid_is_told_of_them() -> None:
    """With and without a surrogate; it would take them for the lens's otherwise."""
    rng, read = np.random.default_rng(1), {}
    for view, T in poses().items():
        turn = from_rotation_vector(np.radians(SIGMA.deg) * rng.standard_normal(3), np.zeros(3))
        read[view] = pose(turn[:3, :3] @ T[:3, :3], T[:3, 3] + SIGMA.mm * rng.standard_normal(3))
    exact = training(read)
    data = replace(exact, X=exact.X + 0.02 * rng.standard_normal(exact.X.shape))
    shoot = SimpleNamespace(nominal_poses=lambda: read)
    plain = CentredTraining(data, cameras(), None, None)
    centred = inspect.unwrap(of_dots._with_stage_errors)(plain, shoot, SIGMA)  # without the checks of types
    assert centred.stage is not None
    for rehearsal in (False, True):
        settings = FitSettings(lens="brown-k1k2", rehearsal=rehearsal)
        methods = pipeline.estimators_of(["hybrid"], settings)
        (model,) = pipeline.fit_methods(of_dots.Training(centred, None, ()), methods, settings)
        assert isinstance(model, Model)
        assert model.estimator.field_px_.tolist() == [0.0, 0.0]
    (without,) = pipeline.fit_methods(of_dots.Training(plain, None, ()), methods, settings)
    assert isinstance(without, Model)
    assert (without.estimator.field_px_ > 0.0).any()
