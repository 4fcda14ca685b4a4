"""A camera and a board that no picture links to the others, placed by the motion of the plate."""

from collections.abc import Mapping
from itertools import combinations
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.geometry.poses import nearest_rotation, pose

if TYPE_CHECKING:
    from labcal.calibrate.boards.sightings import Sightings

_FEWEST_VIEWS = 3
_LEAST_TURN = 0.1
"""Rotation about a second axis, rad, from which on rotations determine a pose."""
_MOST_VIEWS = 60


def placed_through_motion(
    seen: "Sightings", cameras: Mapping[int, Pose], boards: Mapping[int, Pose], views: Mapping[int, Pose]
) -> tuple[tuple[int, Pose], tuple[int, Pose]] | None:
    """Return a camera and a board that it sees, neither of them placed yet, with their places.

    Parameters
    ----------
    seen : Sightings
    cameras, boards : mapping of int to ndarray of shape (4, 4)
        Places that are known, ``T_cam_world`` and ``T_set_board``, mm.
    views : mapping of int to ndarray of shape (4, 4)
        ``T_world_set`` of views in which it is known.

    Returns
    -------
    ((int, ndarray), (int, ndarray)) or None
        None where fewer than three such views are shared, or the plate is hardly turned between them.

    Notes
    -----
    From ``T_cam_board = T_cam_world @ T_world_set @ T_set_board`` in two views, ``A X = X B`` with the
    motions A of the set in the world and B of the board in the camera (Tsai and Lenz 1989); the rotation by
    alignment of the axes of rotation, then both shifts by linear least squares.
    """
    best: tuple[int, int, np.ndarray] | None = None
    for camera in sorted(set(seen.camera.tolist()) - set(cameras)):
        for board in sorted(set(seen.board.tolist()) - set(boards)):
            known = np.isin(seen.view, list(views))
            mine = np.flatnonzero((seen.camera == camera) & (seen.board == board) & known)
            if len(mine) >= _FEWEST_VIEWS and (best is None or len(mine) > len(best[2])):
                best = camera, board, mine
    if best is None:
        return None
    camera, board, mine = best
    mine = mine[:: -(-len(mine) // _MOST_VIEWS)]
    T_world_set = np.stack([views[int(seen.view[k])] for k in mine])
    found = _solved(seen.T_cam_board[mine], T_world_set)
    return None if found is None else ((camera, found[0]), (board, found[1]))


def _solved(
    T_cam_board: Float64[np.ndarray, "n 4 4"], T_world_set: Float64[np.ndarray, "n 4 4"]
) -> tuple[Pose, Pose] | None:
    """Return ``T_cam_world`` and ``T_set_board``; None where the rotations leave them open."""
    pairs = list(combinations(range(len(T_cam_board)), 2))
    in_camera, in_world = (
        np.stack([Rotation.from_matrix(T[b, :3, :3] @ T[a, :3, :3].T).as_rotvec() for a, b in pairs])
        for T in (T_cam_board, T_world_set)
    )
    spread = np.linalg.svd(in_world, compute_uv=False) / np.sqrt(len(pairs))
    if spread[1] < _LEAST_TURN:
        return None
    R_cam_world = Rotation.align_vectors(in_camera, in_world)[0].as_matrix()
    R_set_board = np.mean(
        [(R_cam_world @ W[:3, :3]).T @ C[:3, :3] for C, W in zip(T_cam_board, T_world_set, strict=True)],
        axis=0,
    )
    R_set_board, _ = nearest_rotation(R_set_board)
    # t_cam_board = R_cam_world (R_world_set t_set_board + t_world_set) + t_cam_world
    rows, right = [], []
    for C, W in zip(T_cam_board, T_world_set, strict=True):
        rows.append(np.concatenate([R_cam_world @ W[:3, :3], np.eye(3)], axis=1))
        right.append(C[:3, 3] - R_cam_world @ W[:3, 3])
    x, *_ = np.linalg.lstsq(np.concatenate(rows), np.concatenate(right), rcond=None)
    return pose(R_cam_world, x[3:]), pose(R_set_board, x[:3])
