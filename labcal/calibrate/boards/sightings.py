"""Poses of boards in pictures, and the places of boards and cameras that follow from them."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Pose
from labcal.calibrate.boards.unlinked import placed_through_motion
from labcal.errors import InputError
from labcal.geometry.poses import inverse, pose
from labcal.wording import listed

_CANDIDATES = 100


@dataclass(frozen=True)
class Sightings:
    """n boards seen in pictures, each with its pose.

    Attributes
    ----------
    camera, view, board : ndarray of int, shape (n,)
        Their numbers.
    dots : ndarray of int, shape (n,)
        Measured dots.
    T_cam_board : ndarray, shape (n, 4, 4)
        mm.
    """

    camera: Int64[np.ndarray, " n"]
    view: Int64[np.ndarray, " n"]
    board: Int64[np.ndarray, " n"]
    dots: Int64[np.ndarray, " n"]
    T_cam_board: Float64[np.ndarray, "n 4 4"]


@dataclass(frozen=True)
class Placed:
    """Places of cameras and boards, ``T_cam_world`` and ``T_set_board``, by number; mm."""

    cameras: dict[int, Pose]
    boards: dict[int, Pose]


def placed_boards(seen: Sightings, cameras: Sequence[str], boards: Sequence[str]) -> Placed:
    """Return the places of all cameras and boards, by chains of pictures that link them.

    A board is placed by views in which a placed camera sees it, and any placed camera sees a placed board.
    A camera is placed by views in which it sees a placed board. What no such chain reaches is placed by the
    motion of the plate, as eye and hand of a robot are
    (:func:`~labcal.calibrate.boards.unlinked.placed_through_motion`).

    Parameters
    ----------
    seen : Sightings
    cameras, boards : sequence of str
        Names, for messages. The first camera is the world, the first board the frame of the set.

    Raises
    ------
    InputError
        A board is in no picture, or the views do not link all cameras and boards.
    """
    for number, name in enumerate(boards):
        if not (seen.board == number).any():
            raise InputError(
                f"The board '{name}' is in no picture with enough dots. Leave it out of the targets, or take "
                "pictures that show it."
            )
    first = int(np.argmax(np.bincount(seen.board[seen.camera == 0], minlength=len(boards))))
    placed = Placed({0: np.eye(4)}, {first: np.eye(4)})
    while len(placed.cameras) < len(cameras) or len(placed.boards) < len(boards):
        if not _one_more(seen, placed):
            found = placed_through_motion(seen, placed.cameras, placed.boards, _views(seen, placed))
            if found is None:
                raise InputError(_unlinked(placed, cameras, boards))
            (camera, T_cam_world), (board, T_set_board) = found
            placed.cameras[camera], placed.boards[board] = T_cam_world, T_set_board
    to_first = inverse(placed.boards[0])
    return Placed(placed.cameras, {number: to_first @ T for number, T in placed.boards.items()})


def _views(seen: Sightings, placed: Placed) -> dict[int, Pose]:
    """Return ``T_world_set`` of the views in which a placed camera sees a placed board; by its most dots."""
    found: dict[int, Pose] = {}
    for k in np.argsort(seen.dots, kind="stable"):  # the last one stays
        camera, board = int(seen.camera[k]), int(seen.board[k])
        if camera in placed.cameras and board in placed.boards:
            T_cam_set = seen.T_cam_board[k] @ inverse(placed.boards[board])
            found[int(seen.view[k])] = inverse(placed.cameras[camera]) @ T_cam_set
    return found


def _one_more(seen: Sightings, placed: Placed) -> bool:
    """Place the camera or the board with the most links; tell whether there was one."""
    views = _views(seen, placed)
    links: dict[tuple[str, int], list[Pose]] = {}
    for k, T_cam_board in enumerate(seen.T_cam_board):
        camera, board, view = int(seen.camera[k]), int(seen.board[k]), int(seen.view[k])
        if view not in views or (camera in placed.cameras) == (board in placed.boards):
            continue
        if camera in placed.cameras:
            T = inverse(placed.cameras[camera] @ views[view]) @ T_cam_board
            links.setdefault(("board", board), []).append(T)
        else:
            T = T_cam_board @ inverse(views[view] @ placed.boards[board])
            links.setdefault(("camera", camera), []).append(T)
    if not links:
        return False
    kind, number = max(links, key=lambda link: len(links[link]))
    into = placed.boards if kind == "board" else placed.cameras
    into[number] = middle_pose(np.stack(links[kind, number]))
    return True


def middle_pose(T: Float64[np.ndarray, "n 4 4"]) -> Pose:
    """Return a pose in the middle of several, some of which may be off."""
    turns = T[:, :3, :3].reshape(-1, 9)
    some = turns[:: -(-len(turns) // _CANDIDATES)]
    best = some[np.argmax(np.median(some @ turns.T, axis=1))]
    return pose(best.reshape(3, 3), np.median(T[:, :3, 3], axis=0))


def _unlinked(placed: Placed, cameras: Sequence[str], boards: Sequence[str]) -> str:
    """Return what the views do not link, and what to do about it."""
    lost = [f"camera '{name}'" for number, name in enumerate(cameras) if number not in placed.cameras]
    lost += [f"board '{name}'" for number, name in enumerate(boards) if number not in placed.boards]
    return (
        f"The views do not link {listed(lost)} to camera '{cameras[0]}'. Take views in which a camera sees "
        "two boards, or two cameras see the same board; or three or more in which each camera sees a board "
        "of its own while the plate is turned about different axes."
    )
