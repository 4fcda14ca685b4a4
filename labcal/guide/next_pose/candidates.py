"""Poses to choose the next one from: anywhere that cameras see, tilted every way, as a hand can hold it."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.guide.next_pose.findable import MOST_TILT_DEG
from labcal.guide.next_pose.hand import USUAL, HandError
from labcal.guide.next_pose.volume import middle_of_eyes

_SURE_NEAR, _SURE_FAR = 0.8, 1.25
_STEP = 0.05
"""Of the range of distances, which shrinks where the target was not found."""
_ROLL_DEG = 20.0
"""Turn about the normal beside quarter turns: as a hand would hold it."""


def nearby_poses(
    T_world_target: Pose, middle: Vectors3, spread: float, count: int, random: np.random.Generator
) -> Float64[np.ndarray, "count 4 4"]:
    """Return poses about one: turned by about `spread` rad and moved by that share of its distance."""
    R, t = T_world_target[:3, :3], T_world_target[:3, 3]
    held = R @ middle + t
    turns = Rotation.from_rotvec(spread * random.standard_normal((count, 3))).as_matrix() @ R
    moved = held + spread * np.linalg.norm(held) * random.standard_normal((count, 3)) / np.sqrt(3.0)
    return np.array([pose(turn, place - turn @ middle) for turn, place in zip(turns, moved, strict=True)])


@dataclass(frozen=True)
class HandReach:
    """Reach of a hand that holds the target: places, distances and quarter turns.

    Attributes
    ----------
    centre : float64 array, (3,)
        Where the middle of the target was held first, mm.
    quarters : int
        Quarter turns to draw from: 1 (always upright) to 4.
    near, far : float
        Distances from the cameras, as shares of the one at which the target was held first.
    hand : HandError
        Its errors, with which the target must still be found.
    """

    centre: Vectors3
    quarters: int
    near: float = 0.6
    far: float = 1.5
    hand: HandError = USUAL

    def without(self, share: float) -> "HandReach":
        """Return the reach without distances at which the target was not found, from a share of the first on.

        The first distance itself, and a quarter to both sides, always stay.
        """
        if share < 1.0:
            return replace(self, near=max(self.near, min(_SURE_NEAR, share + _STEP)))
        return replace(self, far=min(self.far, max(_SURE_FAR, share - _STEP)))

    def share(self, cameras: tuple[Camera, ...], place: Vectors3) -> float:
        """Return the distance of a place from the cameras, over that of the first one."""
        eyes = middle_of_eyes(cameras)
        return float(np.linalg.norm(place - eyes) / np.linalg.norm(self.centre - eyes))


def drawn_poses(
    cameras: tuple[Camera, ...],
    reach: HandReach,
    middle: Vectors3,
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
    reach : HandReach
    middle : ndarray, shape (3,)
        Of the target in its own frame, mm.
    count : int
    random : Generator
    """
    eyes = middle_of_eyes(cameras)
    usual = float(np.linalg.norm(reach.centre - eyes))
    places = np.full((count, 3), np.nan)
    distance = usual * random.uniform(reach.near, reach.far, count)
    of, pixel = random.integers(len(cameras), size=count), random.uniform(size=(count, 2))
    for number, camera in enumerate(cameras):
        mine = of == number
        ray = camera.rays(pixel[mine] * (np.array(camera.size) - 1.0))
        places[mine] = np.where(
            ray.ok[:, None], ray.origin + distance[mine, None] * ray.direction, reach.centre
        )
    toward = (eyes - places) / np.linalg.norm(eyes - places, axis=1, keepdims=True)
    along = cameras[0].T_cam_world[0, :3]
    right = along - (toward @ along)[:, None] * toward
    right /= np.linalg.norm(right, axis=1, keepdims=True)
    facing = np.stack([right, np.cross(toward, right), toward], axis=2)
    tilt = np.radians(MOST_TILT_DEG) * np.sqrt(random.uniform(size=count))
    azimuth = random.uniform(0.0, 2.0 * np.pi, count)
    quarter = random.integers(reach.quarters, size=count)
    roll = np.radians(90.0 * quarter + _ROLL_DEG * random.uniform(-1.0, 1.0, count))
    axis = np.stack([np.cos(azimuth), np.sin(azimuth), np.zeros(count)], axis=-1)
    about_normal = Rotation.from_rotvec(roll[:, None] * [0.0, 0.0, 1.0])
    R = facing @ (Rotation.from_rotvec(tilt[:, None] * axis) * about_normal).as_matrix()
    T = np.tile(np.eye(4), (count, 1, 1))
    T[:, :3, :3], T[:, :3, 3] = R, places - R @ middle
    return T
