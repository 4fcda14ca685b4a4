"""Training views whose pictures bear each other's camera's name; reconstruction is in test_reconstruction."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.agreement.exchange.by_places import refuse_exchanged_by_places
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, stage_points
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]


@pytest.fixture
def three(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> TrainingData:
    T = pair["right"].T_cam_world.copy()
    T[:3, 3] *= [-1, 1, 1]
    T[:3, :3] = T[:3, :3].T
    cameras = pair | {"third": replace(pair["right"], T_cam_world=T)}
    matches = match(see(cameras, grid, poses), tuple(cameras))
    sizes = tuple(camera.size for camera in cameras.values())
    p = stage_points(matches, grid, poses)
    return TrainingData(tuple(cameras), sizes, matches.view, matches.index, matches.X, p)


def test_views_as_they_should_be_are_let_through(three: TrainingData) -> None:
    refuse_exchanged_by_places(three)


@pytest.mark.parametrize(
    ("order", "named"), [((1, 0, 2), "'left' and 'right'"), ((0, 2, 1), "'right' and 'third'")]
)
def test_exchanged_pictures_of_a_view_are_named(
    order: tuple[int, ...], named: str, three: TrainingData
) -> None:
    rows, X = three.view == "pose-5", three.X.copy()
    X[rows] = X[rows].reshape(-1, 3, 2)[:, order].reshape(-1, 6)
    with pytest.raises(InputError, match=f"Pictures of {named} are exchanged in view 'pose-5'"):
        refuse_exchanged_by_places(replace(three, X=X))


def test_dots_that_are_wrong_otherwise_are_not_called_swapped(three: TrainingData) -> None:
    noise = 5.0 * np.random.default_rng(0).standard_normal(three.X.shape)
    refuse_exchanged_by_places(replace(three, X=three.X + noise))
