"""Dots as exactly known cameras see them, without a picture."""

from collections.abc import Callable, Mapping
from dataclasses import fields

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.targets.grid import DotGrid

See = Callable[[Mapping[str, Camera], DotGrid, Mapping[str, np.ndarray]], Detections]


def _see(cameras: Mapping[str, Camera], target: DotGrid, poses: Mapping[str, np.ndarray]) -> Detections:
    """Return the centres of all dots, projected by OpenCV, with a variance of 0.01 px squared."""
    parts = []
    for view, T_world_target in poses.items():
        for name, camera in cameras.items():
            T = camera.T_cam_world @ T_world_target
            q, _ = cv2.projectPoints(
                target.points(), cv2.Rodrigues(T[:3, :3])[0], T[:3, 3], camera.K, camera.dist
            )
            parts.append((view, name, camera.size, q[:, 0]))
    counts, n = target.count, target.count * len(parts)
    return Detections(
        view=np.repeat(np.array([part[0] for part in parts], dtype=np.str_), counts),
        camera=np.repeat(np.array([part[1] for part in parts], dtype=np.str_), counts),
        image=np.repeat(np.array([f"{part[0]}_{part[1]}.png" for part in parts], dtype=np.str_), counts),
        size=np.repeat(np.array([part[2] for part in parts], dtype=np.int64), counts, axis=0),
        index=np.tile(target.indices().astype(np.int64), (len(parts), 1)),
        has_id=np.ones(n, dtype=bool),
        position=np.concatenate([part[3] for part in parts]),
        covariance=np.tile(0.01 * np.eye(2), (n, 1, 1)),
        flag=np.full(n, "ok", dtype="<U16"),  # room for every flag
    )


@pytest.fixture
def see() -> See:
    """Return what makes detections of a target at poses (by view) in cameras (by name)."""
    return _see


_RIM = 720


def _rims(grid: DotGrid) -> np.ndarray:
    """Return points around every dot, (dots, n, 3), in mm."""
    angle = 2 * np.pi * np.arange(_RIM) / _RIM
    circle = np.stack([np.cos(angle), np.sin(angle), np.zeros(_RIM)], axis=1)
    return grid.points()[:, None] + 0.5 * grid.outer_diameters_mm()[:, None, None] * circle


def _centre_of_area(outline: np.ndarray) -> np.ndarray:
    """Return the centres of area of polygons (n, corners, 2), by the shoelace formula."""
    middle = outline.mean(axis=1, keepdims=True)
    a = outline - middle
    b = np.roll(a, -1, axis=1)
    cross = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
    return middle[:, 0] + ((a + b) * cross[..., None]).sum(axis=1) / (3.0 * cross.sum(axis=1)[:, None])


def _centroids(cameras: Mapping[str, Camera], grid: DotGrid, poses: Mapping[str, np.ndarray]) -> Detections:
    """Return what a perfect detector measures, centres of area, with a variance of 1e-4 px squared."""
    parts = []
    for view, T in poses.items():
        for name, camera in cameras.items():
            outline = camera.project(_rims(grid) @ T[:3, :3].T + T[:3, 3]).q
            whole = camera.in_picture(outline).all(axis=1)
            n = grid.count
            parts.append(
                Detections(
                    view=np.full(n, view),
                    camera=np.full(n, name),
                    image=np.full(n, "none.png"),
                    size=np.tile(np.array(camera.size, dtype=np.int64), (n, 1)),
                    index=grid.indices().astype(np.int64),
                    has_id=np.ones(n, dtype=bool),
                    position=_centre_of_area(outline),
                    covariance=np.tile(1e-4 * np.eye(2), (n, 1, 1)),
                    flag=np.where(whole, "ok", "cut"),
                )
            )
    return Detections(
        *(np.concatenate([getattr(part, f.name) for part in parts]) for f in fields(Detections))
    )


@pytest.fixture
def centroids() -> See:
    """Return what makes detections of centres of area, of the dots that are wholly in the picture."""
    return _centroids


@pytest.fixture
def pair() -> dict[str, Camera]:
    """Two barrel-distorted cameras; the left one's frame is the world."""
    T = np.eye(4)
    T[:3, :3] = cv2.Rodrigues(np.array([0.02, 0.25, -0.03]))[0]
    T[:3, 3] = [-180.0, 6.0, 25.0]
    K = np.array([[700.0, 0.0, 322.4], [0.0, 704.0, 237.1], [0.0, 0.0, 1.0]])
    left, right = np.array([-0.3, 0.09, 6e-4, -4e-4, 0.0]), np.array([-0.28, 0.1, -5e-4, 7e-4, 0.01])
    return {
        "left": Camera(K, "brown5", left, np.eye(4), (640, 480)),
        "right": Camera(K - np.diag([9.0, 8.0, 0.0]), "brown5", right, T, (640, 480)),
    }


@pytest.fixture
def poses(grid: DotGrid) -> dict[str, np.ndarray]:
    """Eight places of a hand-held target in front of the pair, tilted every way."""
    rng = np.random.default_rng(21)
    middle = grid.points().mean(axis=0)
    found = {}
    for number in range(8):
        azimuth = 2 * np.pi * number / 8
        tilt, _ = cv2.Rodrigues(0.5 * np.array([np.cos(azimuth), np.sin(azimuth), rng.normal()]))
        T = np.eye(4)
        T[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ tilt
        T[:3, 3] = rng.uniform([-40, -30, 250], [60, 30, 320]) - T[:3, :3] @ middle
        found[f"pose-{number}"] = T
    return found
