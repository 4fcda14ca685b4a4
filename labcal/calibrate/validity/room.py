"""A room as the world of a rig, by marks that stay where they are: then all cameras have places of their own.

The room takes the first place among the cameras, has no pictures, and is where the rig's first camera was.
"""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.camera import Camera
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import inverse

ROOM = "room"


def in_room(cameras: tuple[Camera, ...]) -> tuple[Camera, ...]:
    """Return the room and the cameras of a rig, whose first one is where the room has its origin."""
    return (replace(cameras[0], T_cam_world=np.eye(4)), *cameras)


def out_of_room(cameras: tuple[Camera, ...]) -> tuple[Camera, ...]:
    """Return the cameras as a rig, whose world is its first camera."""
    back = inverse(cameras[1].T_cam_world)
    first = replace(cameras[1], T_cam_world=np.eye(4))
    return (first, *(replace(camera, T_cam_world=camera.T_cam_world @ back) for camera in cameras[2:]))


def rig_positions(state: RigState) -> Int64[np.ndarray, " rig"]:
    """Return the positions of a rig's parameters, in the order of ``rig.json``, among those of the room."""
    layout = _layout(state)
    found = [np.arange(layout.lens[1].start, layout.lens[1].stop)]
    for lens, pose in zip(layout.lens[2:], layout.pose[2:], strict=True):
        found.append(np.arange(lens.start, pose.stop))
    return np.concatenate(found)


def rig_columns(state: RigState) -> Float64[np.ndarray, "rig shared"]:
    """Return the derivatives of a rig's parameters, in the order of ``rig.json``, by those of the room.

    Notes
    -----
    With the room's poses (R1, t1) of the first camera and (R, t) of another one, the other one's pose in the
    first one's frame has Q = R R1' and t - Q t1. A turn w of the first camera turns it by -Q w.
    """
    layout, at = _layout(state), rig_positions(state)
    found = np.zeros((len(at), layout.count))
    found[np.arange(len(at)), at] = 1.0
    T_first = state.cameras[1].T_cam_world
    turn = slice(layout.pose[1].start, layout.pose[1].start + 3)
    shift = slice(turn.stop, layout.pose[1].stop)
    for camera, pose in zip(state.cameras[2:], layout.pose[2:], strict=True):
        Q = camera.T_cam_world[:3, :3] @ T_first[:3, :3].T
        rows = np.flatnonzero(np.isin(at, np.arange(pose.start, pose.stop)))
        own = slice(pose.start, pose.start + 3)
        found[rows[:3], turn] = -Q
        found[rows[3:], turn] = -Q @ cross_matrices(T_first[None, :3, 3])[0]
        found[rows[3:], shift] = -Q
        found[rows[3:], own] = cross_matrices((Q @ T_first[:3, 3])[None])[0]
    return found


def _layout(state: RigState) -> Layout:
    """Return the positions of the room's parameters, marks left out."""
    return Layout(state, Freedom(Lenses.FREE, np.zeros((state.dots.size, 0))))
