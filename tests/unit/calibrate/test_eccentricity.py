"""Centroid minus centre taken off matches, training data and points."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal.calibrate.eccentricity import CorrectedEccentricity, centred
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, stage_points
from labcal.correspond.training import TrainingData
from labcal.estimators.centred_training import centred_training
from labcal.estimators.dlt import Dlt
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.model_file import load_model, save_model
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]


@pytest.fixture
def large(grid: DotGrid) -> DotGrid:
    """The target with dots that nearly touch."""
    return grid.model_copy(update={"dot_diameter_mm": 11.0, "ring_outer_diameter_mm": 11.0})


@pytest.fixture
def pinholes(pair: Cameras) -> Cameras:
    """The pair without distortion, which the direct linear transform explains exactly."""
    return {name: replace(camera, lens="pinhole", dist=np.zeros(5)) for name, camera in pair.items()}


def test_figures() -> None:
    eccentricity = CorrectedEccentricity.of(np.array([[3.0, 4.0], [0.0, 0.0]]))
    assert (eccentricity.rms, eccentricity.max) == (pytest.approx(np.sqrt(12.5)), 5.0)
    assert CorrectedEccentricity.of(np.zeros((0, 2))) == CorrectedEccentricity(0.0, 0.0)


def test_matches_come_to_the_centres(centroids: See, pair: Cameras, large: DotGrid, poses: Poses) -> None:
    matches = match(centroids(pair, large, poses), ("left", "right"))
    p = stage_points(matches, large, poses)
    true = np.stack([camera.project(p).q for camera in pair.values()], axis=1)
    found, eccentricity = centred(tuple(pair.values()), matches, large)
    raw = np.linalg.norm(matches.q - true, axis=-1)
    assert eccentricity.max == pytest.approx(raw.max(), rel=0.02)
    assert np.linalg.norm(found.q - true, axis=-1).max() < 0.02 * raw.max()


def test_a_view_without_a_pose_stays_as_it_is(
    centroids: See, pair: Cameras, large: DotGrid, poses: Poses
) -> None:
    matches = match(centroids(pair, large, poses), ("left", "right"))
    on_a_line = (matches.view == "pose-0") & (matches.index[:, 1] != 0)
    few = matches.where(~on_a_line)
    found, _ = centred(tuple(pair.values()), few, large)
    untouched = few.view == "pose-0"
    np.testing.assert_array_equal(found.q[untouched], few.q[untouched])
    assert (found.q[~untouched] != few.q[~untouched]).all()


def test_a_rig_reconstructs_centres(centroids: See, pair: Cameras, large: DotGrid, poses: Poses) -> None:
    dots = centroids(pair, large, poses)
    raw, found = (reconstruct_centres(Rig.of(pair), dots, target) for target in (None, large))
    errors = []
    for points in (raw.points, found.points):
        matches = match(dots, ("left", "right"))
        errors.append(np.linalg.norm(points.point - stage_points(matches, large, poses), axis=1).max())
    assert raw.eccentricity is None
    assert found.eccentricity is not None
    assert errors[1] < 0.03 * errors[0]


def test_a_method_learns_and_gives_centres(
    centroids: See, pinholes: Cameras, large: DotGrid, poses: Poses, tmp_path: Path
) -> None:
    names = list(poses)
    stage = {name: poses[name] for name in names[:5]}
    data = training(centroids(pinholes, large, stage), large, stage)
    taught = centred_training(data, large, stage)
    assert taught.eccentricity is not None
    assert taught.reason is None
    box = TrainingBox.of(data.X, data.Y)
    tests = {name: poses[name] for name in names[5:]}
    dots = centroids(pinholes, large, tests)
    truth = stage_points(match(dots, data.cameras), large, tests)

    def rms(model: Model, target: DotGrid | None) -> float:
        off = reconstruct_centres(model, dots, target).points.point - truth
        return float(np.sqrt((off**2).sum(axis=1).mean()))

    raw = Model(Dlt().fit(data.X, data.Y), data.cameras, data.image_sizes, box)
    centre = Model(
        Dlt().fit(taught.data.X, taught.data.Y), data.cameras, data.image_sizes, box, taught.cameras
    )
    assert rms(raw, large) == rms(raw, None)  # it was taught centroids
    assert rms(centre, large) < 0.05 * rms(raw, None)
    path = tmp_path / "model"
    save_model(path, centre, force=False)
    assert rms(load_model(path), large) == rms(centre, large)


def test_one_plane_is_left_as_it_is(centroids: See, pinholes: Cameras, large: DotGrid, poses: Poses) -> None:
    stage = {"pose-0": poses["pose-0"]}
    data = training(centroids(pinholes, large, stage), large, stage)
    found = centred_training(data, large, stage)
    assert found.data is data
    assert found.cameras is found.eccentricity is None
    assert found.reason is not None
    assert "one plane" in found.reason


def training(dots: Detections, grid: DotGrid, poses: Poses) -> TrainingData:
    matches = match(dots, ("left", "right"))
    sizes = ((640, 480), (640, 480))
    Y = stage_points(matches, grid, poses)
    return TrainingData(matches.cameras, sizes, matches.view, matches.index, matches.X, Y)
