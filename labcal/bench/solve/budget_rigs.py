"""Pairs of cameras of three kinds, and a target held before them, for the benchmark of the error budget."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.targets.grid import DotGrid, Rings

_TILT = 0.35
"""Standard deviation of the target's rotation about each axis, rad."""
_VOLUME = np.array([[-1.0, -0.7, 0.85], [1.0, 0.7, 1.2]])
"""Corners of the volume: across in units of the reach, along in units of the distance."""


@dataclass(frozen=True)
class PairKind:
    """A kind of pair; both cameras look at the middle of the volume.

    Attributes
    ----------
    size : (int, int)
        Width and height of the pictures, px.
    focal_px, baseline_mm, distance_mm : float
    reach_mm : float
        By which the middle of the target moves to both sides.
    board_mm : float
        Width of the target.
    print_mm : float
        Standard deviation of dots on an uneven print.
    dist : tuple of tuple of float
        Of brown5, by camera.
    """

    size: tuple[int, int]
    focal_px: float
    baseline_mm: float
    distance_mm: float
    reach_mm: float
    board_mm: float
    print_mm: float
    dist: tuple[tuple[float, ...], tuple[float, ...]]

    def cameras(self) -> tuple[Camera, Camera]:
        """Return the true cameras; the first one is the world."""
        toward = np.arctan2(0.5 * self.baseline_mm, self.distance_mm)
        turned = Rotation.from_rotvec([0.01, 2.0 * toward, 0.005]).as_matrix()
        # The first camera looks along z; the second stands so that both axes meet at the distance.
        across = self.distance_mm * np.tan(2.0 * toward)
        place = pose(turned, -turned @ np.array([across, 3.0, 5.0]))
        u, v = (self.size[0] - 1) / 2.0, (self.size[1] - 1) / 2.0
        focal = (self.focal_px, 1.01 * self.focal_px)
        middle = ((u + 4.0, v - 6.0), (u - 5.0, v + 3.0))
        made = [
            Camera([[f, 0.0, cx], [0.0, 1.002 * f, cy], [0.0, 0.0, 1.0]], "brown5", dist, T, self.size)
            for f, (cx, cy), dist, T in zip(focal, middle, self.dist, (np.eye(4), place), strict=True)
        ]
        return made[0], made[1]

    def target(self) -> DotGrid:
        """Return the target, which has rings so that its dots can be freed."""
        pitch = self.board_mm / 12.0
        return DotGrid(
            name="held", cols=13, rows=10, pitch_x_mm=pitch, pitch_y_mm=pitch, dot_diameter_mm=pitch / 3.0,
            ring_outer_diameter_mm=0.6 * pitch, ring_inner_diameter_mm=0.25 * pitch,
            rings=Rings(origin=(3, 3), x=(9, 3), y=(3, 7)), margin_mm=0.5 * pitch,
        )  # fmt: skip

    def poses(self, views: int, random: np.random.Generator) -> list[Pose]:
        """Return ``T_world_target`` of views in which both cameras see the whole target."""
        p, found = self.target().points(), list[Pose]()
        while len(found) < views:
            tilt = Rotation.from_rotvec(_TILT * random.standard_normal(3)).as_matrix()
            R = np.diag([1.0, -1.0, -1.0]) @ tilt
            T = pose(R, self._places(1, random)[0] - R @ p.mean(axis=0))
            if self._seen(p @ T[:3, :3].T + T[:3, 3]).all():
                found.append(T)
        return found

    def points(self, count: int, random: np.random.Generator) -> Vectors3:
        """Return points anywhere in the volume that both cameras see, mm."""
        found = np.empty((0, 3))
        while len(found) < count:
            p = self._places(count, random)
            found = np.concatenate([found, p[self._seen(p)]])
        return found[:count]

    def _places(self, count: int, random: np.random.Generator) -> Vectors3:
        scale = np.array([self.reach_mm, self.reach_mm, self.distance_mm])
        return np.asarray(scale * random.uniform(_VOLUME[0], _VOLUME[1], (count, 3)))

    def _seen(self, p: Vectors3) -> np.ndarray:
        images = [(camera, camera.project(p)) for camera in self.cameras()]
        seen = [image.ok & camera.in_picture(image.q) for camera, image in images]
        return np.asarray(np.all(seen, axis=0))


KINDS: Mapping[str, PairKind] = {
    "wide": PairKind(
        (1280, 960), 700.0, 250.0, 1000.0, 250.0, 260.0, 0.02,
        ((-0.22, 0.06, 4e-4, -3e-4, -0.006), (-0.2, 0.05, -3e-4, 2e-4, -0.005)),
    ),
    "narrow": PairKind(
        (2464, 2056), 8500.0, 300.0, 1200.0, 60.0, 130.0, 0.003,
        ((-0.1, 0.3, 4e-4, -3e-4, 0.0), (-0.12, 0.2, -3e-4, 2e-4, 0.0)),
    ),
    "webcam": PairKind(
        (1280, 720), 950.0, 120.0, 700.0, 130.0, 180.0, 0.02,
        ((0.08, -0.2, 1e-3, -5e-4, 0.02), (0.07, -0.18, -6e-4, 8e-4, 0.02)),
    ),
}  # fmt: skip
"""The narrow one is like the pair of the photographs that tests are made on."""
