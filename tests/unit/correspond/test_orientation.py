"""Numberings of plain grids that agree, on pictures whose own numbering is drawn at random."""

from collections.abc import Mapping

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.correspond.orientation import resolve_orientation
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid, Polarity

PLAIN = load_target("plain-11x8")
SQUARE = PLAIN.model_copy(update={"cols": 8})


def picture(camera: Camera, T_world_target: np.ndarray, target: DotGrid, own: int) -> PictureDots:
    """Return all dots where OpenCV projects them, called as if the target were turned `own` times."""
    T = camera.T_cam_world @ T_world_target
    q, _ = cv2.projectPoints(target.points(), cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)
    n = target.count
    index = target.indices()
    dots = PictureDots(
        (640, 480), Polarity.BLACK_ON_WHITE, None, index, np.ones(n, dtype=bool), q[:, 0],
        np.tile(np.eye(2), (n, 1, 1)), np.ones(n), (DotFlag.OK,) * n, q[:, 0], np.tile(np.eye(2), (n, 1, 1)),
        target.symmetric_indices(index),
    )  # fmt: skip
    return dots if own == 0 else dots.renumbered(own - 1)


def views(target: DotGrid, count: int, roll: float, seed: int) -> dict[str, np.ndarray]:
    """Return places in front of the pair, tilted up to 30 degrees and rolled up to `roll` radians."""
    rng = np.random.default_rng(seed)
    found = {}
    for number in range(count):
        tilt, _ = cv2.Rodrigues(0.5 * rng.uniform(-1, 1, 3) * [1, 1, 0])
        spin, _ = cv2.Rodrigues(np.array([0, 0, rng.uniform(-roll, roll)]))
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ tilt @ spin
        T[:3, 3] = rng.uniform([60, -30, 500], [100, 30, 600]) - T[:3, :3] @ target.points().mean(axis=0)
        found[f"v{number}"] = T
    return found


def turned(camera: Camera, degrees: float) -> Camera:
    """Return the camera rolled about its axis."""
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(np.array([0, 0, np.radians(degrees)]))[0]
    return Camera(camera.K, camera.lens, camera.dist, T @ camera.T_cam_world, camera.size)


def called(dots: PictureDots, target: DotGrid, camera: Camera, T: np.ndarray) -> int:
    """Return how often the target would have to be turned for the dots to be called as they are."""
    truth = picture(camera, T, target, 0)
    places = {tuple(q): index for q, index in zip(truth.position.tolist(), truth.index.tolist(), strict=True)}
    true_index = np.array([places[tuple(q)] for q in dots.position.tolist()])
    numberings = (true_index, *target.symmetric_indices(true_index))
    return next(k for k, index in enumerate(numberings) if np.array_equal(index, dots.index))


def settle(
    cameras: Mapping[str, Camera], target: DotGrid, poses: Mapping[str, np.ndarray], seed: int
) -> dict[str, list[int | None]]:
    """Return, by camera, how every view's dots are called after settling; None where refused."""
    rng = np.random.default_rng(seed)
    fold = 1 + len(target.symmetric_indices(target.indices()[:1]))
    keys = [(view, name) for view in poses for name in cameras]
    sources = [Source(view, name, f"{view}_{name}.png", None) for view, name in keys]
    seen = [picture(cameras[name], poses[view], target, int(rng.integers(fold))) for view, name in keys]
    found: dict[str, list[int | None]] = {name: [] for name in cameras}
    for (view, name), dots in zip(keys, resolve_orientation(sources, seen, target), strict=True):
        if dots.refusal is None:
            assert len(dots.others) == fold - 1
            order = np.lexsort((dots.index[:, 0], dots.index[:, 1]))
            assert np.array_equal(order, np.arange(len(order)))  # still sorted
            found[name].append(called(dots, target, cameras[name], poses[view]))
        else:
            assert dots.refusal is Refusal.AMBIGUOUS
            assert not dots.has_id.any()
            found[name].append(None)
    return found


@pytest.mark.parametrize("target", [PLAIN, SQUARE])
@pytest.mark.parametrize(("count", "roll"), [(1, 0.3), (1, 3.1), (6, 0.2), (6, 3.1)])
def test_both_cameras_agree_in_every_view(
    target: DotGrid, count: int, roll: float, pair: dict[str, Camera]
) -> None:
    for seed in range(3):
        found = settle(pair, target, views(target, count, roll, seed), seed)
        assert None not in found["left"]
        assert found["left"] == found["right"]
        if roll < 0.25:  # turned little from view to view, and held upright in the first one
            assert found["left"] == [0] * count


@pytest.mark.parametrize("degrees", [90.0, 180.0, -120.0])
def test_cameras_turned_far_agree_by_their_epipolar_geometry(degrees: float, pair: dict[str, Camera]) -> None:
    cameras = {"left": pair["left"], "right": turned(pair["right"], degrees)}
    for seed in range(2):
        found = settle(cameras, PLAIN, views(PLAIN, 6, 3.1, seed), seed)
        assert None not in found["left"]
        assert found["left"] == found["right"]


def test_cameras_turned_by_a_right_angle_are_refused_where_only_one_view_could_tell(
    pair: dict[str, Camera],
) -> None:
    cameras = {"left": pair["left"], "right": turned(pair["right"], 90.0)}
    found = settle(cameras, PLAIN, views(PLAIN, 1, 0.2, 3), 3)
    assert found == {"left": [0], "right": [None]}


def test_cameras_that_never_see_the_target_together_are_left_alone(pair: dict[str, Camera]) -> None:
    poses = views(PLAIN, 2, 0.1, 5)
    sources = [Source("v0", "left", "a.png", None), Source("v1", "right", "b.png", None)]
    pictures = [picture(pair[s.camera], poses[s.view], PLAIN, 0) for s in sources]
    assert resolve_orientation(sources, pictures, PLAIN) == pictures


def test_a_target_with_rings_is_left_alone(pair: dict[str, Camera]) -> None:
    target = load_target("rings-10x8")
    dots = picture(pair["left"], views(target, 1, 0.1, 5)["v0"], target, 0)
    assert resolve_orientation([Source("v0", "left", "a.png", None)], [dots], target) == [dots]
