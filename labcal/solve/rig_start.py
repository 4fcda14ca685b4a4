"""Where the adjustment of a whole rig begins: each camera calibrated alone, brought into one world."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.errors import InputError
from labcal.geometry.poses import inverse, pose
from labcal.solve.adjustment.state import RigState

_CANDIDATES = 100


@dataclass(frozen=True)
class LoneCamera:
    """A camera in its own frame, and where it saw the target."""

    name: str
    camera: Camera
    views: Int64[np.ndarray, " n"]
    """Numbers of the views in the rig's adjustment."""
    T_cam_target: Float64[np.ndarray, "n 4 4"]


def rig_start(cameras: Sequence[LoneCamera], dots: Float64[np.ndarray, "dots 3"]) -> RigState:
    """Return cameras and target poses in the first camera's frame.

    Parameters
    ----------
    cameras : sequence of LoneCamera
        Every view is seen by at least one.
    dots : ndarray, shape (dots, 3)
        Places in the target's frame, mm.

    Raises
    ------
    InputError
        A camera shares no view with the first one.
    """
    views = 1 + max(int(lone.views.max()) for lone in cameras)
    T_world_target = np.full((views, 4, 4), np.nan)
    placed = []
    for lone in cameras:
        T_cam_world = np.eye(4) if lone is cameras[0] else _place(lone, cameras[0])
        placed.append(replace(lone.camera, T_cam_world=T_cam_world))
        new = np.isnan(T_world_target[lone.views, 0, 0])
        T_world_target[lone.views[new]] = inverse(T_cam_world) @ lone.T_cam_target[new]
    return RigState(tuple(placed), T_world_target, dots)


def _place(lone: LoneCamera, first: LoneCamera) -> Pose:
    """Return ``T_cam_world`` from the views that both cameras share, some of which may be off."""
    _, here, there = np.intersect1d(lone.views, first.views, return_indices=True)
    if len(here) == 0:
        raise InputError(
            f"Cameras '{first.name}' and '{lone.name}' share no view with enough dots in both. Shoot the "
            "target where both cameras see it, and check that --cameras names the pairs."
        )
    T = lone.T_cam_target[here] @ np.linalg.inv(first.T_cam_target[there])
    # Of some, the rotation with the least median distance to all: the trace falls with the angle.
    turns = T[:, :3, :3].reshape(-1, 9)
    some = turns[:: -(-len(turns) // _CANDIDATES)]
    best = some[np.argmax(np.median(some @ turns.T, axis=1))]
    return pose(best.reshape(3, 3), np.median(T[:, :3, 3], axis=0))
