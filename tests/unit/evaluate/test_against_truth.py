"""Errors against a truth that is written for the purpose."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest
from edited import edited

from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.evaluate.against_truth import TruthErrors, errors_against_truth
from labcal.pipeline import epipolar_rms, evaluate
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.shoot.truth import TrueDots, TrueView, Truth, write_truth
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]


def a_shoot(
    folder: Path,
    pair: Cameras,
    grid: DotGrid,
    poses: Poses,
    roles: dict[str, Role] | None,
    misprint: np.ndarray | float = 0.0,
) -> Shoot:
    """Write the truth; with roles the target was on a stage, without in the hand.

    When the second camera looks, every dot is elsewhere, which must play no part.
    """
    views = tuple(
        ViewEntry(
            name=name,
            images={"left": f"images/{name}.png"},
            role=roles[name] if roles else Role.TRAIN,
            T_world_target_nominal=matrix4_record(T) if roles else None,
        )
        for name, T in poses.items()
    )
    cameras = {name: CameraRecord.of(camera) for name, camera in pair.items()}
    true_views = {name: TrueView(T_world_target=matrix4_record(T)) for name, T in poses.items()}
    nowhere = np.full((grid.count, 2), np.nan)
    dots = [
        TrueDots(
            view=name,
            camera=camera,
            index=grid.indices(),
            point=grid.points() @ T[:3, :3].T + T[:3, 3] + off,
            centre=nowhere,
            centroid=nowhere,
            visible=np.zeros(grid.count, dtype=bool),
        )
        for name, T in poses.items()
        for camera, off in (("left", misprint), ("right", 7.0))
    ]
    write_truth(folder, Truth(cameras=cameras, views=true_views), dots)
    size = CameraEntry(size=(640, 480))
    return Shoot(folder, Manifest(target=grid, cameras=dict.fromkeys(pair, size), views=views))


def true_points(grid: DotGrid, poses: Poses) -> Points:
    n = grid.count * len(poses)
    return Points(
        view=np.repeat(list(poses), grid.count),
        index=np.tile(grid.indices(), (len(poses), 1)),
        point=np.concatenate([grid.points() @ T[:3, :3].T + T[:3, 3] for T in poses.values()]),
        covariance=np.full((n, 3, 3), np.nan),
        flag=np.full(n, "ok"),
    )


def staged() -> tuple[Poses, dict[str, Role]]:
    """Return a lower and an upper plane to train on, one half-way and one outside to test on."""
    poses = {}
    for name, x, z in (("low", 0, 300), ("high", 0, 400), ("middle", 10, 350), ("outside", 0, 450)):
        T = np.diag([1.0, -1.0, -1.0, 1.0])
        T[:3, 3] = [x - 40, 20, z]
        poses[name] = T
    return poses, dict(zip(poses, [Role.TRAIN, Role.TRAIN, Role.TEST, Role.TEST], strict=True))


def test_on_a_stage_only_test_dots_within_the_trained_hull_count(
    tmp_path: Path, pair: Cameras, grid: DotGrid
) -> None:
    poses, roles = staged()
    shoot = a_shoot(tmp_path, pair, grid, poses, roles)
    points = true_points(grid, poses)
    points = replace(points, point=points.point + np.array([1.0, -2.0, 2.0]))
    lost = (points.view == "middle") & (points.index == 0).all(axis=1)
    points = edited(points, "point", lost, np.nan)
    found = errors_against_truth(points, shoot, None)
    # The view half-way lies half a pitch further in x, so that its last column is outside; one dot is lost.
    assert found.n == grid.rows * (grid.cols - 1) - 1
    assert found.not_scored == 4 * grid.count - found.n
    assert found.alignment == "none"
    np.testing.assert_allclose(found.mean_signed_mm, [1, -2, 2], atol=1e-9)
    assert found.rmse_mm == pytest.approx(3)
    assert np.isnan(found.limit_mm)
    assert np.isnan(found.coverage95)


def test_dots_count_where_they_truly_were(tmp_path: Path, pair: Cameras, grid: DotGrid) -> None:
    poses, roles = staged()
    misprint = np.random.default_rng(1).normal(size=(grid.count, 3))
    misprint[:, 2] = 0.0  # in the plane, so that the tested dots stay within the trained hull's heights
    shoot = a_shoot(tmp_path, pair, grid, poses, roles, misprint)
    points = true_points(grid, poses)
    points = replace(points, point=points.point + np.tile(misprint, (len(poses), 1)))
    assert errors_against_truth(points, shoot, None).max_mm < 1e-9
    as_designed = errors_against_truth(true_points(grid, poses), shoot, None)
    assert as_designed.rmse_mm == pytest.approx(np.sqrt(2), rel=0.3)


def test_a_hand_held_target_is_aligned_first(
    tmp_path: Path, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    shoot = a_shoot(tmp_path, pair, grid, poses, None)
    points = true_points(grid, poses)
    R, _ = cv2.Rodrigues(np.array([0.3, -1.0, 2.0]))
    moved = replace(points, point=points.point @ R.T + [500, 600, -700])
    found = errors_against_truth(moved, shoot, None)
    assert found.alignment == "rigid"
    assert found.n == len(points)
    assert found.max_mm < 1e-9
    larger = errors_against_truth(replace(moved, point=moved.point * 1.01), shoot, None)
    assert larger.rmse_mm > 0.1  # scale is no part of the alignment


def test_noisy_pixels_reach_the_limit_and_are_covered(
    tmp_path: Path, see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    shoot = a_shoot(tmp_path, pair, grid, poses, None)
    exact = see(pair, grid, poses)
    noise = 0.1 * np.random.default_rng(3).normal(size=exact.position.shape)
    noisy = replace(exact, position=exact.position + noise)
    found = evaluate(reconstruct_points(Rig.of(pair), noisy), shoot, noisy)
    assert isinstance(found, TruthErrors)
    assert found.limit_mm * 0.85 < found.rmse_mm < found.limit_mm * 1.15
    assert 0.88 < found.coverage95 <= 1.0
    singular = replace(noisy, covariance=np.zeros_like(noisy.covariance))
    assert np.isnan(errors_against_truth(true_points(grid, poses), shoot, singular).limit_mm)
    # Perpendicular distances of noise: sigma of the one picture, and what the other's adds.
    assert 0.1 < epipolar_rms(Rig.of(pair), noisy) < 0.2
    assert epipolar_rms(Rig.of(pair), exact) < 1e-8
    assert np.isnan(epipolar_rms(Rig.of({"left": pair["left"]}), exact))


def test_points_that_cannot_be_scored_are_refused(
    tmp_path: Path, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    shoot = a_shoot(tmp_path, pair, grid, poses, None)
    points = true_points(grid, poses)
    with pytest.raises(InputError, match="hold view 'elsewhere', which the shoot"):
        errors_against_truth(replace(points, view=np.full(len(points), "elsewhere")), shoot, None)
    with pytest.raises(InputError, match=r"None of the 160 points can be scored"):
        errors_against_truth(replace(points, point=points.point * np.nan), shoot, None)
    on_stage, roles = staged()
    (tmp_path / "stage").mkdir()
    stage = a_shoot(tmp_path / "stage", pair, grid, on_stage, roles)
    trained = true_points(grid, on_stage)
    with pytest.raises(InputError, match="points of test views within the trained hull would be"):
        errors_against_truth(trained.where(trained.view == "low"), stage, None)


@pytest.mark.parametrize("file", ["dots.csv", "truth.json"])
def test_a_truth_that_lacks_a_camera_is_not_the_shoots(
    file: str, tmp_path: Path, pair: Cameras, grid: DotGrid, poses: Poses, see: See
) -> None:
    shoot = a_shoot(tmp_path, pair, grid, poses, None)
    detections = see(pair, grid, poses)
    points = reconstruct_points(Rig.of(pair), detections)
    path = tmp_path / "truth" / file
    if file == "dots.csv":
        lines = path.read_text().splitlines(keepends=True)
        path.write_text("".join(line for line in lines if ",right," not in line))
    else:
        content = json.loads(path.read_text())
        del content["cameras"]["right"]
        path.write_text(json.dumps(content))
    with pytest.raises(InputError, match=rf"{file} lacks camera 'right'"):
        errors_against_truth(points, shoot, detections)
