"""Poses and names of cameras on the way between rigs and other systems' files."""

import re
from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from labcal.arrays import Matrix3, Pose
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.geometry.poses import inverse, pose, require_rigid

MM_IN_M = 1000.0
_ROUNDED = 1e-3
"""Largest deviation from a rotation of a matrix that was written with few digits."""


def poses_from_first(rig: Rig) -> tuple[list[Pose], tuple[str, ...]]:
    """Return ``T_cam_first`` of every camera, mm, and a note where that is not the rig's world."""
    in_world = [np.array(record.T_cam_world) for record in rig.cameras.values()]
    if np.array_equal(in_world[0], np.eye(4)):
        return in_world, ()
    first = next(iter(rig.cameras))
    T_world_first = inverse(in_world[0])
    note = f"The format has no world of its own: the first camera, '{first}', is the world in it."
    return [np.eye(4), *(T_cam_world @ T_world_first for T_cam_world in in_world[1:])], (note,)


def poses_along(T_next_before: Sequence[Pose]) -> list[Pose]:
    """Return ``T_cam_first`` of cameras in a chain, the first one included, from each one's step."""
    poses = [np.eye(4)]
    for step in T_next_before:
        poses.append(step @ poses[-1])
    return poses


def steps_along(T_cam_first: Sequence[Pose]) -> list[Pose]:
    """Return ``T_cam_before`` of all cameras of a chain but the first."""
    before = [inverse(T) for T in T_cam_first]
    return [T if at == 1 else T @ before[at - 1] for at, T in enumerate(T_cam_first) if at > 0]


def rounded_pose(R_ab: Matrix3, t_ab: np.ndarray, source: Path) -> tuple[Pose, tuple[str, ...]]:
    """Return ``T_ab`` from a matrix that may have been rounded, and a note where that was mended.

    Raises
    ------
    InputError
        The matrix is no rotation, even allowing for rounding.
    """
    T_ab = pose(R_ab, t_ab)
    try:
        require_rigid(T_ab, "the pose")
    except InputError as error:
        U, stretch, Vt = np.linalg.svd(R_ab)
        if not np.isfinite(T_ab).all() or np.abs(stretch - 1.0).max() > _ROUNDED or np.linalg.det(R_ab) < 0:
            raise InputError(f"{source}: {error}") from error
        note = f"{source}: a rotation is rounded to few digits; the nearest rotation is taken."
        return pose(U @ Vt, t_ab), (note,)
    return T_ab, ()


def clean_names(wanted: Iterable[str]) -> list[str]:
    """Return names of letters, digits and hyphens, each once."""
    names: list[str] = []
    for text in wanted:
        name = re.sub("[^A-Za-z0-9]+", "-", text).strip("-") or "camera"
        twins = sum(known == name or known.startswith(f"{name}-again") for known in names)
        names.append(name if not twins else f"{name}-again{twins}")
    return names


def rig_of(names: Sequence[str], records: Sequence[CameraRecord]) -> Rig:
    """Return the rig of cameras with these names, in their order."""
    return Rig(cameras=dict(zip(clean_names(names), records, strict=True)))


def scaled_rig(rig: Rig, scale: float) -> Rig:
    """Return a rig whose lengths are multiplied by `scale`."""
    if scale == 1.0:
        return rig
    records = {}
    for name, record in rig.cameras.items():
        camera = record.camera()
        T = camera.T_cam_world.copy()
        T[:3, 3] *= scale
        records[name] = CameraRecord.of(replace(camera, T_cam_world=T))
    return Rig(cameras=records)
