"""Poses to choose the next one from: anywhere that cameras see, tilted every way, as a hand can hold it."""

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.guide.next_pose.findable import MOST_TILT_DEG
from labcal.guide.next_pose.volume import middle_of_eyes

_NEAR, _FAR = 0.6, 1.5
"""Distances, as shares of the one at which the target was held first."""
_ROLL_DEG = 20.0
"""Turn about the normal beside quarter turns: as a hand would hold it."""


def nearby_poses(
    T_world_target: Pose, middle: Vectors3, spread: float, count: int, random: np.random.Generator
) -> Float64[np.ndarray, "count 4 4"]:
    """Return poses about one: turned by `spread` rad, and moved by that share of the distance, normal both."""
    R, t = T_world_target[:3, :3], T_world_target[:3, 3]
    held = R @ middle + t
    turns = Rotation.from_rotvec(spread * random.standard_normal((count, 3))).as_matrix() @ R
    moved = held + spread * np.linalg.norm(held) * random.standard_normal((count, 3)) / np.sqrt(3.0)
    return np.array([pose(turn, place - turn @ middle) for turn, place in zip(turns, moved, strict=True)])


def drawn_poses(
    cameras: tuple[Camera, ...],
    centre: Vectors3,
    middle: Vectors3,
    quarters: int,
    count: int,
    random: np.random.Generator,
) -> Float64[np.ndarray, "count 4 4"]:
    """Draw poses, ``T_world_target``, mm.

    Places are spread evenly over the picture of one of the cameras, chosen by chance, and over distances;
    tilts over the disc of those at which dots can be measured.

    Parameters
    ----------
    cameras : tuple of Camera
        The first one is the world.
    centre : ndarray, shape (3,)
        Where the target was held first, mm.
    middle : ndarray, shape (3,)
        Of the target in its own frame, mm.
    quarters : int
        Quarter turns of the target to draw from: 1 (always upright) to 4.
    count : int
    random : Generator
    """
    eyes = middle_of_eyes(cameras)
    usual = float(np.linalg.norm(centre - eyes))
    drawn = []
    while len(drawn) < count:
        camera = cameras[int(random.integers(len(cameras)))]
        ray = camera.rays(random.uniform(0.0, 1.0, (1, 2)) * (np.array(camera.size) - 1.0))
        distance = usual * random.uniform(_NEAR, _FAR)
        share, azimuth = random.uniform(size=2)
        roll = np.radians(90.0 * random.integers(quarters) + _ROLL_DEG * random.uniform(-1.0, 1.0))
        if not ray.ok[0]:
            continue
        place = ray.origin[0] + distance * ray.direction[0]
        toward = (eyes - place) / np.linalg.norm(eyes - place)
        right = cameras[0].T_cam_world[0, :3] - (cameras[0].T_cam_world[0, :3] @ toward) * toward
        right /= np.linalg.norm(right)
        facing = np.stack([right, np.cross(toward, right), toward], axis=1)
        tilt = np.radians(MOST_TILT_DEG) * np.sqrt(share)
        axis = np.array([np.cos(2.0 * np.pi * azimuth), np.sin(2.0 * np.pi * azimuth), 0.0])
        turn = Rotation.from_rotvec(tilt * axis) * Rotation.from_rotvec([0.0, 0.0, roll])
        R = facing @ turn.as_matrix()
        drawn.append(pose(R, place - R @ middle))
    return np.array(drawn)
