"""Initial values of the adjustment of a rig: single-camera calibrations in one world."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Pose
from labcal.calibrate.adjustment.state import RigState
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import inverse, pose

_CANDIDATES = 100


@dataclass(frozen=True)
class SingleCamera:
    """A camera in its own frame, and its poses of the target."""

    name: str
    camera: Camera
    views: Int64[np.ndarray, " n"]
    """Numbers of the views in the rig's adjustment."""
    T_cam_target: Float64[np.ndarray, "n 4 4"]


@dataclass(frozen=True)
class SharedViews:
    """Views that two cameras share."""

    views: Int64[np.ndarray, " n"]
    first: Float64[np.ndarray, "n 4 4"]
    """Poses of the target in the first camera."""
    second: Float64[np.ndarray, "n 4 4"]

    @classmethod
    def of(cls, one: SingleCamera, other: SingleCamera) -> "SharedViews":
        """Return those of two cameras; there may be none."""
        views, here, there = np.intersect1d(one.views, other.views, return_indices=True)
        return cls(views, one.T_cam_target[here], other.T_cam_target[there])


def rig_start(cameras: Sequence[SingleCamera], dots: Float64[np.ndarray, "dots 3"]) -> RigState:
    """Return cameras and target poses in the first camera's frame.

    Parameters
    ----------
    cameras : sequence of SingleCamera
        Every view is seen by at least one.
    dots : ndarray, shape (dots, 3)
        Places in the target's frame, mm.

    Raises
    ------
    InputError
        A camera shares no view with the first one, not even through others.
    """
    views = 1 + max(int(single.views.max()) for single in cameras)
    T_world_target = np.full((views, 4, 4), np.nan)
    placed = placed_cameras(cameras)
    for single, T_cam_world in zip(cameras, placed, strict=True):
        new = np.isnan(T_world_target[single.views, 0, 0])
        T_world_target[single.views[new]] = inverse(T_cam_world) @ single.T_cam_target[new]
    pairs = zip(cameras, placed, strict=True)
    return RigState(tuple(replace(single.camera, T_cam_world=T) for single, T in pairs), T_world_target, dots)


def placed_cameras(cameras: Sequence[SingleCamera]) -> list[Pose]:
    """Return ``T_cam_world`` of every camera; the first one is the world.

    A camera is placed by the placed one with which it shares most views: the tree of cameras that hangs
    together best (Prim 1957).

    Raises
    ------
    InputError
        A camera shares no view with the first one, not even through others.
    """
    placed: dict[int, Pose] = {0: np.eye(4)}
    while len(placed) < len(cameras):
        waiting = [number for number in range(len(cameras)) if number not in placed]
        shared = {(old, new): SharedViews.of(cameras[old], cameras[new]) for old in placed for new in waiting}
        old, new = max(shared, key=lambda pair: len(shared[pair].views))
        if len(shared[old, new].views) == 0:
            known = f"'{cameras[0].name}'" if len(placed) == 1 else "the rest of the rig"
            raise InputError(
                f"Cameras {known} and '{cameras[new].name}' share no view with enough dots in both. Shoot "
                "the target where both see it, and check that `cameras` names the pairs. Pictures whose "
                "names do not pair up are paired in their order by folders or lists: "
                "`cameras='left=left.txt,right=right.txt'`."
            )
        placed[new] = pose_between(shared[old, new]) @ placed[old]
    return [placed[number] for number in range(len(cameras))]


def pose_between(shared: SharedViews) -> Pose:
    """Return ``T_second_first`` from the views that two cameras share, some of which may be off."""
    T = shared.second @ np.linalg.inv(shared.first)
    # Of some, the rotation with the least median distance to all: the trace falls with the angle.
    turns = T[:, :3, :3].reshape(-1, 9)
    some = turns[:: -(-len(turns) // _CANDIDATES)]
    best = some[np.argmax(np.median(some @ turns.T, axis=1))]
    return pose(best.reshape(3, 3), np.median(T[:, :3, 3], axis=0))
