from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.record import matrix4_record
from labcal.correspond.detections import Detections
from labcal.correspond.training import training_data
from labcal.errors import InputError
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]


def shoot(grid: DotGrid, poses: Poses, *, handheld: bool = False) -> Shoot:
    """Return a shoot whose last two views are for testing; nothing is on disk."""
    views = tuple(
        ViewEntry(
            name=view,
            images={"left": f"images/{view}_left.png", "right": f"images/{view}_right.png"},
            role=Role.TEST if view in list(poses)[-2:] else Role.TRAIN,
            T_world_target_nominal=None if handheld else matrix4_record(T),
        )
        for view, T in poses.items()
    )
    size = CameraEntry(size=(640, 480))
    return Shoot(Path("shoot"), Manifest(target=grid, cameras={"left": size, "right": size}, views=views))


def test_training_views_alone_are_learned_from(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    data = training_data(shoot(grid, poses), see(pair, grid, poses))
    assert data.cameras == ("left", "right")
    assert data.image_sizes == ((640, 480), (640, 480))
    assert set(data.view) == set(list(poses)[:-2])
    assert data.X.shape == (6 * grid.count, 4)
    assert np.isfinite(data.Y).all()
    for column, camera in enumerate(pair.values()):
        projected = camera.project(data.Y).q
        np.testing.assert_allclose(data.X[:, 2 * column : 2 * column + 2], projected, atol=1e-9)


def test_what_teaches_nothing_is_refused(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> None:
    exact = see(pair, grid, poses)
    with pytest.raises(InputError, match=r"hand-held.*labcal calibrate"):
        training_data(shoot(grid, poses, handheld=True), exact)
    with pytest.raises(InputError, match="No dot of a training view was measured by all cameras"):
        training_data(shoot(grid, poses), exact.where(np.isin(exact.view, list(poses)[-2:])))
    with pytest.raises(InputError, match="no detections of camera right"):
        training_data(shoot(grid, poses), exact.where(exact.camera == "left"))
    with pytest.raises(InputError, match="Name the target"):
        training_data(shoot(grid, poses), replace(exact, index=exact.index + 1))


def test_a_target_that_looks_the_same_when_turned_teaches_nothing_on_a_stage(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    nothing = {"rings": None, "ring_outer_diameter_mm": None, "ring_inner_diameter_mm": None}
    plain = DotGrid.model_validate(grid.model_dump() | nothing)
    with pytest.raises(InputError, match=r"'small' looks the same when it is turned.*rings"):
        training_data(shoot(plain, poses), see(pair, plain, poses))
    changes = {"layout": "asymmetric", "rows": 5, "pitch_y_mm": 10.0}
    leaning = DotGrid.model_validate(plain.model_dump() | changes)
    assert len(training_data(shoot(leaning, poses), see(pair, leaning, poses)).X) == 6 * 25
