"""Poses of a board in the hand of which both cameras take pictures that can be read."""

from collections.abc import Mapping

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose, Vectors3
from labcal.bench.solve.budget_rigs import PairKind
from labcal.cameras.camera import Camera
from labcal.geometry.poses import inverse, pose, transform
from labcal.scene.printed import key_indices
from labcal.targets.april_grid import AprilGrid
from labcal.targets.charuco import CharucoBoard
from labcal.targets.charuco_opencv import opencv_dictionary
from labcal.targets.target import PrintableTarget

BOARDS: Mapping[str, str] = {
    "chessboard": "chessboard-9x6",
    "marked chessboard": "chessboard-marked-13x8",
    "charuco": "charuco-12x9",
    "aprilgrid": "aprilgrid-6x6",
    "dots": "webcam-a4",
}
"""A shipped target of each kind; the last one for comparison."""
PAIR = PairKind(
    (640, 480), 560.0, 150.0, 520.0, 90.0, 240.0, 0.0,
    ((-0.2, 0.06, 6e-4, -4e-4, 0.0), (-0.21, 0.07, -5e-4, 7e-4, 0.0)),
)  # fmt: skip
LEAST_SQUARE_PX, LEAST_CELL_PX, LEAST_DOT_PX = 6.0, 1.5, 8.0
"""Least width in a picture of a chessboard's square, of a marker's cell, and of a dot: down to these the
benchmarks of the detector judge its pictures (:mod:`labcal.bench.boards`, ``targets`` designed for dots)."""
MOST_TILT_DEG = 70.0
"""Between a board's normal and the line of sight to its middle."""
_TILT = 0.4
"""Standard deviation of the board's rotation about each axis, rad."""
_NEAR, _FAR = 0.8, 1.25
"""Of the pair's distance."""
_IN_SIGHT = 0.7
"""Share of the places of a board that both cameras see at least."""
_FRAME_PX = 8.0
"""Distance from the frame of a place that is in sight."""


def least_feature(target: PrintableTarget) -> tuple[float, float]:
    """Return the smallest part of a target that must be distinguished, mm, and its least width, px."""
    if isinstance(target, AprilGrid):
        cells = opencv_dictionary(target.dictionary).markerSize + 2 * target.border_cells
        return target.tag_mm / cells, LEAST_CELL_PX
    if isinstance(target, CharucoBoard):
        return target.marker_mm / (opencv_dictionary(target.dictionary).markerSize + 2), LEAST_CELL_PX
    diameters = target.outer_diameters_mm()
    if (diameters > 0.0).all():
        return float(diameters.min()), LEAST_DOT_PX
    places = target.points()
    return float(np.linalg.norm(places[1] - places[0])), LEAST_SQUARE_PX


def board_poses(target: PrintableTarget, views: int, random: np.random.Generator) -> list[Pose]:
    """Return ``T_world_target`` of views in which both cameras see enough of a board to number it.

    No board is tilted by more than :data:`MOST_TILT_DEG`, and none is so small, as a whole or where it is
    farthest, that its smallest parts are narrower than :func:`least_feature` says.

    Parameters
    ----------
    target : PrintableTarget
        Boards of every size are held as far away as they look equally wide.
    views : int
    random : Generator
    """
    p = target.points()
    x_min, y_min, x_max, y_max = target.extent_mm
    scale = max(x_max - x_min, y_max - y_min) / PAIR.board_mm
    cameras = PAIR.cameras()
    key = np.array([row * target.cols + col for col, row in key_indices(target)], dtype=np.int64)
    low, high = np.full(2, _FRAME_PX), np.array(PAIR.size) - 1.0 - _FRAME_PX
    size_mm, least_px = least_feature(target)
    found = list[Pose]()
    while len(found) < views:
        turn = Rotation.from_rotvec(_TILT * random.standard_normal(3)).as_matrix()
        R = np.diag([1.0, -1.0, -1.0]) @ turn
        sideways = PAIR.reach_mm * random.uniform(-1.0, 1.0, 2)
        middle = scale * np.array([*sideways, PAIR.distance_mm * random.uniform(_NEAR, _FAR)])
        T = pose(R, middle - R @ p.mean(axis=0))
        if max(tilt_deg(camera, T, p.mean(axis=0)) for camera in cameras) > MOST_TILT_DEG:
            continue
        q = np.stack([camera.project(transform(T, p)).q for camera in cameras])
        seen = np.asarray(((q > low) & (q < high)).all(axis=(0, 2)))
        if seen.mean() < _IN_SIGHT or not seen[key].all():
            continue
        widths = [size_mm * narrowest_px(camera, T, p[seen]) for camera in cameras]
        if min(float(width.min()) for width in widths) >= least_px:
            found.append(T)
    return found


def tilt_deg(camera: Camera, T_world_target: Pose, middle: np.ndarray) -> float:
    """Return the angle between a board's normal and the line of sight to its middle (3,), degrees."""
    sight = transform(inverse(T_world_target), camera.centre) - middle
    return float(np.degrees(np.arccos(sight[2] / np.linalg.norm(sight))))


def narrowest_px(camera: Camera, T_world_target: Pose, p: Vectors3) -> np.ndarray:
    """Return the least width of a disc of 1 mm at places of a board, px, shape (n,).

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Mm.
    p : ndarray, shape (n, 3)
        Target frame, mm.
    """
    here, along, up = (
        camera.project(transform(T_world_target, p + np.array(step))).q
        for step in ((0.0, 0.0, 0.0), (0.1, 0.0, 0.0), (0.0, 0.1, 0.0))
    )
    J = np.stack([along - here, up - here], axis=-1) / 0.1
    return np.asarray(np.linalg.svd(J, compute_uv=False)[:, -1])
