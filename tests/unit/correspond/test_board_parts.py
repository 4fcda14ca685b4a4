"""Parts of boards whose dots are all alike, placed by another camera, on dots where OpenCV projects them."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.correspond.board_parts import UNPLACED, place_parts
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.lattice.rings import TURNS
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid, Polarity

PLAIN = load_target("plain-11x8")
assert isinstance(PLAIN, DotGrid)
True_ids = dict[tuple[float, ...], tuple[int, ...]]


def seen(camera: Camera, T: np.ndarray, target: DotGrid, rng: np.random.Generator) -> PictureDots:
    """Return all dots, with noise of 0.05 px."""
    T = camera.T_cam_world @ T
    q, _ = cv2.projectPoints(target.points(), cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist)
    q, n, index = q[:, 0] + rng.normal(0, 0.05, (target.count, 2)), target.count, target.indices()
    shape = np.tile(np.eye(2), (n, 1, 1))
    return PictureDots(
        (640, 480), Polarity.BLACK_ON_WHITE, None, index, np.ones(n, dtype=bool), q, shape, np.ones(n),
        (DotFlag.OK,) * n, q, shape, target.symmetric_indices(index),
    )  # fmt: skip


def in_part(whole: PictureDots, target: DotGrid, rng: np.random.Generator) -> PictureDots:
    """Return a refused picture that shows a part of the columns, under its numberings in random order."""
    cols = int(rng.integers(5, 9))
    first = int(rng.integers(0, target.cols - cols + 1))
    kept = (whole.index[:, 0] >= first) & (whole.index[:, 0] < first + cols)
    index = whole.index[kept]
    found = []
    for turn in (TURNS[0], TURNS[2]):  # the others would swap the pitches
        places = index @ turn.T
        low, high = places.min(axis=0), places.max(axis=0)
        found += [
            places + np.array([right, up])
            for right in range(-low[0], target.cols - high[0])
            for up in range(-low[1], target.rows - high[1])
        ]
    found = [found[k] for k in rng.permutation(len(found))]
    order = np.lexsort((found[0][:, 0], found[0][:, 1]))
    n, q = int(kept.sum()), whole.position[kept][order]
    part = replace(
        whole, index=found[0][order], has_id=np.ones(n, dtype=bool), position=q,
        covariance=whole.covariance[:n], misfit=np.ones(n), flag=(DotFlag.OK,) * n, seen_at=q,
        outline=whole.outline[:n], others=tuple(one[order] for one in found[1:]),
    )  # fmt: skip
    return replace(part.refused(Refusal.AMBIGUOUS), part=part)


def held(tilt: float, count: int, rng: np.random.Generator) -> list[np.ndarray]:
    """Return places of the target in front of the pair, tilted about x and y by up to `tilt` radians."""
    poses = []
    for _ in range(count):
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ cv2.Rodrigues(tilt * rng.uniform(-1, 1, 3) * [1, 1, 0.3])[0]
        T[:3, 3] = rng.uniform([60, -30, 420], [100, 30, 520]) - T[:3, :3] @ PLAIN.points().mean(axis=0)
        poses.append(T)
    return poses


def placed(
    pair: dict[str, Camera], tilt: float, seed: int, views: int = 5
) -> tuple[list[PictureDots], list[True_ids]]:
    """Return what becomes of the right camera's pictures, which show parts, and the ids of their dots."""
    rng = np.random.default_rng(seed)
    sources, pictures, ids = [], [], []
    for view, T in enumerate(held(tilt, views, rng)):
        left, right = (seen(camera, T, PLAIN, rng) for camera in pair.values())
        pairs = zip(right.position.tolist(), right.index.tolist(), strict=True)
        ids.append({tuple(q): tuple(index) for q, index in pairs})
        pictures += [left, in_part(right, PLAIN, rng)]
        sources += [Source(f"v{view}", name, f"{view}_{name}.png", None) for name in pair]
    return place_parts(sources, pictures, PLAIN)[1::2], ids


def right_ids(dots: PictureDots, ids: True_ids) -> bool:
    return all(
        ids[tuple(q)] == tuple(index)
        for q, index in zip(dots.position.tolist(), dots.index.tolist(), strict=True)
    )


@pytest.mark.parametrize("seed", [1, 2, 3])
def test_parts_are_placed_by_a_camera_that_sees_the_whole_board(seed: int, pair: dict[str, Camera]) -> None:
    for dots, ids in zip(*placed(pair, 0.6, seed), strict=True):
        assert dots.refusal is None
        assert dots.others
        assert right_ids(dots, ids)


def test_boards_that_are_always_parallel_stay_refused(pair: dict[str, Camera]) -> None:
    for dots, _ in zip(*placed(pair, 0.02, 4), strict=True):
        assert dots.refusal is Refusal.AMBIGUOUS
        assert dots.detail == UNPLACED
        assert not dots.has_id.any()


def test_two_views_are_too_few(pair: dict[str, Camera]) -> None:
    dots, _ = placed(pair, 0.6, 5, views=2)
    assert [one.refusal for one in dots] == [Refusal.AMBIGUOUS] * 2


def test_no_part_is_placed_wrongly_whatever_the_tilt(pair: dict[str, Camera]) -> None:
    settled = 0
    for seed, tilt in enumerate((0.05, 0.1, 0.15, 0.2, 0.3)):
        for dots, ids in zip(*placed(pair, tilt, 10 + seed, 4), strict=True):
            settled += dots.refusal is None
            assert dots.refusal is not None or right_ids(dots, ids)
    assert settled >= 4
