"""Points from a rig and from a fitted method, and what is refused."""

from collections.abc import Callable
from dataclasses import fields, replace
from pathlib import Path

import numpy as np
import pytest

from labcal.calibrate.triangulation_residuals import MOST_PX
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import write_rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, stage_points
from labcal.errors import InputError
from labcal.estimators.affine import Affine
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import save_model
from labcal.reconstruct.reconstruction import load_reconstructor, reconstruct_centres, reconstruct_points
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]


def fitted(detections: Detections, grid: DotGrid, poses: Poses) -> Model:
    matches = match(detections, ("left", "right"))
    Y = stage_points(matches, grid, poses)
    box = TrainingBox.of(matches.X, Y)
    return Model(Affine().fit(matches.X, Y), ("left", "right"), ((640, 480), (640, 480)), box)


def test_a_rig_gives_points_with_covariances(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    order = np.random.default_rng(1).permutation(len(exact))
    shuffled = Detections(*(getattr(exact, field.name)[order] for field in fields(exact)))
    found = reconstruct_points(Rig.of(pair), shuffled)
    assert len(found) == len(poses) * grid.count
    for view, T in poses.items():
        of_view = found.where(found.view == view)
        np.testing.assert_array_equal(of_view.index, grid.indices())  # sorted by row and column
        np.testing.assert_allclose(of_view.point, grid.points() @ T[:3, :3].T + T[:3, 3], atol=1e-6)
    assert set(found.flag) == {"ok"}
    assert (np.linalg.eigvalsh(found.covariance) > 0).all()
    wider = reconstruct_points(Rig.of(pair), replace(exact, covariance=4 * exact.covariance))
    assert np.median(wider.covariance / 4) == pytest.approx(np.median(found.covariance), rel=1e-6)


def test_dots_of_one_camera_alone_give_no_point(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    keep = (exact.camera == "left") | (exact.index[:, 0] == 2)
    flag = np.where(exact.index[:, 1] == 3, "bad-fit", exact.flag)
    found = reconstruct_points(Rig.of(pair), replace(exact, flag=flag).where(keep))
    assert {tuple(i) for i in found.index.tolist()} == {(2, 0), (2, 1), (2, 2)}


def test_what_cannot_be_solved_is_flagged(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    covariance = exact.covariance.copy()
    covariance[0] = 0.0
    found = reconstruct_points(Rig.of(pair), replace(exact, covariance=covariance))
    assert found.flag[0] == "no-solution"
    assert np.isnan(found.point[0]).all()
    assert set(found.flag[1:]) == {"ok"}


def test_a_method_states_covariances_and_flags(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    trained = exact.where(exact.view != "pose-7")
    model = fitted(trained, grid, poses)
    found = reconstruct_points(model, exact)
    X = match(exact, ("left", "right")).X
    np.testing.assert_array_equal(found.point, model.estimator.predict(X))
    assert (np.linalg.eigvalsh(found.covariance) > 0).all()
    outside = ((found.point < model.box.low_mm) | (found.point > model.box.high_mm)).any(axis=1)
    assert outside.any()
    assert not outside.all()
    np.testing.assert_array_equal(found.flag == "extrapolated", outside)
    assert set(found.flag) == {"ok", "extrapolated"}


def test_both_kinds_of_model_are_read(
    tmp_path: Path, see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    model = fitted(see(pair, grid, poses), grid, poses)
    write_rig(tmp_path / "rig.json", Rig.of(pair))
    save_model(tmp_path / "model", model, force=False)
    assert load_reconstructor(tmp_path / "rig.json") == Rig.of(pair)
    assert isinstance(load_reconstructor(tmp_path / "model"), Model)
    (tmp_path / "else").write_text("view,col")
    with pytest.raises(InputError, match="neither a model"):
        load_reconstructor(tmp_path / "else")


def test_what_does_not_belong_to_the_model_is_refused(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    exact = see(pair, grid, poses)
    for model in (Rig.of(pair), fitted(exact, grid, poses)):
        with pytest.raises(InputError, match="no detections of camera right, only of left"):
            reconstruct_points(model, exact.where(exact.camera == "left"))
        with pytest.raises(InputError, match=r"320 x 240\. Calibrate again with pictures of this size"):
            reconstruct_points(model, replace(exact, size=exact.size // 2))
        with pytest.raises(InputError, match="No dot was measured by all of the cameras left, right"):
            reconstruct_points(model, exact.where((exact.camera == "left") == (exact.view == "pose-0")))
    with pytest.raises(InputError, match="A rig with one camera"):
        reconstruct_points(Rig.of({"left": pair["left"]}), exact)


def exchanged(detections: Detections, view: str) -> Detections:
    other = np.where(detections.camera == "left", "right", "left")
    return replace(detections, camera=np.where(detections.view == view, other, detections.camera))


def noisy(detections: Detections) -> Detections:
    sigma = np.sqrt(detections.covariance[0, 0, 0])
    noise = sigma * np.random.default_rng(5).standard_normal(detections.position.shape)
    return replace(detections, position=detections.position + noise)


def test_exchanged_pictures_are_told_by_view(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = noisy(see(pair, grid, poses))
    centred = replace(fitted(exact, grid, poses), resected=tuple(pair.values()))
    for model in (Rig.of(pair), centred):
        assert set(reconstruct_points(model, exact).flag) <= {"ok", "extrapolated"}
        with pytest.raises(InputError, match=r"Pictures of .* are exchanged in view 'pose-3'"):
            reconstruct_points(model, exchanged(exact, "pose-3"))


def test_a_dot_that_is_elsewhere_is_flagged(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = noisy(see(pair, grid, poses))
    position = exact.position.copy()
    position[7, 1] += 20 * np.sqrt(exact.covariance[7, 1, 1])
    found = reconstruct_points(Rig.of(pair), replace(exact, position=position))
    wrong = (found.view == exact.view[7]) & (found.index == exact.index[7]).all(axis=1)
    np.testing.assert_array_equal(found.flag == "model-misfit", wrong)


def test_a_rig_that_was_bumped_is_told(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    turned = pair["right"].T_cam_world.copy()
    turned[1, 3] += 10.0
    moved = pair | {"right": replace(pair["right"], T_cam_world=turned)}
    found = reconstruct_centres(Rig.of(moved), exact, None)
    assert found.miss_px is not None
    assert found.miss_px > MOST_PX
    assert set(found.points.flag) == {"model-misfit"}
    still = reconstruct_centres(Rig.of(pair), exact, None)
    assert still.miss_px == pytest.approx(0.0, abs=1e-6)


def test_another_target_is_told(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    larger = grid.model_copy(update={"name": "larger", "pitch_x_mm": 40.0, "pitch_y_mm": 40.0})
    smaller = grid.model_copy(update={"name": "smaller", "cols": 4})
    for model in (Rig.of(pair), replace(fitted(exact, grid, poses), resected=tuple(pair.values()))):
        with pytest.raises(InputError, match=r"0\.\d+ times as far apart as the dots of the target 'larger'"):
            reconstruct_centres(model, exact, larger)
        with pytest.raises(InputError, match="the target 'smaller' has 4 x"):
            reconstruct_centres(model, exact, smaller)
