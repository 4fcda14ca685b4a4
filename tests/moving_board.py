"""Drawn videos of a board that a hand moves before two cameras."""

from pathlib import Path

import cv2
import numpy as np

from labcal.geometry.poses import from_rotation_vector
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

SIZE = (480, 360)
FOCAL = 520.0
RATE = 25.0
TARGET = "plain-11x8"


def board(target: DotGrid) -> tuple[np.ndarray, np.ndarray]:
    """Return a picture of the board, and the matrix from the target (mm) to it (px)."""
    scale = 4.0  # px/mm
    x_min, y_min, x_max, y_max = target.extent_mm
    width, height = int((x_max - x_min) * scale), int((y_max - y_min) * scale)
    picture = np.full((height, width), 235, np.uint8)
    for x, y, _ in target.points():
        middle = (round(16 * (x - x_min) * scale), round(16 * (y_max - y) * scale))
        radius = round(16 * 0.5 * target.dot_diameter_mm * scale)
        cv2.circle(picture, middle, radius, 30, -1, cv2.LINE_AA, 4)
    to_picture = np.array([[scale, 0.0, -x_min * scale], [0.0, -scale, y_max * scale], [0.0, 0.0, 1.0]])
    return picture, to_picture


def pose_at(seconds: float) -> np.ndarray:
    """Return the pose of the board, mm: a hand that moves and turns it smoothly."""
    turn = np.array(
        [np.pi + 0.25 * np.sin(3.1 * seconds), 0.3 * np.sin(2.3 * seconds + 1.0), 0.1 * np.sin(seconds)]
    )
    place = np.array(
        [40.0 * np.sin(2.7 * seconds), 25.0 * np.cos(3.7 * seconds), 30.0 * np.sin(1.9 * seconds)]
    )
    return from_rotation_vector(turn, place)


def frame(target: DotGrid, T_cam_world: np.ndarray, seconds: float, distance: float) -> np.ndarray:
    """Return what a camera sees at a moment."""
    picture, to_picture = board(target)
    K = np.array([[FOCAL, 0.0, 0.5 * SIZE[0]], [0.0, FOCAL, 0.5 * SIZE[1]], [0.0, 0.0, 1.0]])
    T = pose_at(seconds)
    middle = target.points().mean(axis=0)
    T[:3, 3] += [0.0, 0.0, distance] - T[:3, :3] @ middle
    T = T_cam_world @ T
    to_camera = K @ np.column_stack([T[:3, 0], T[:3, 1], T[:3, 3]])
    warped = cv2.warpPerspective(
        picture, to_camera @ np.linalg.inv(to_picture), SIZE, flags=cv2.INTER_AREA, borderValue=120
    )
    return cv2.GaussianBlur(warped, (0, 0), 0.8)


def write_video(path: Path, frames: list[np.ndarray]) -> Path:
    """Write frames as a video with little loss."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter_fourcc(*"MJPG"), RATE, SIZE)
    writer.set(cv2.VIDEOWRITER_PROP_QUALITY, 98)
    for picture in frames:
        writer.write(cv2.cvtColor(picture, cv2.COLOR_GRAY2BGR))
    writer.release()
    return path


def two_videos(folder: Path, offset: float, count: int = 75) -> tuple[Path, Path]:
    """Write two videos; a moment comes `offset` frames later in the second one."""
    target = load_target(TARGET)
    left = np.eye(4)
    right = from_rotation_vector(np.array([0.0, 0.25, 0.0]), np.array([-100.0, 0.0, 12.0]))
    distance = 2.2 * (target.extent_mm[2] - target.extent_mm[0])
    paths = []
    for name, T_cam_world, late in (("left", left, 0.0), ("right", right, offset)):
        pictures = [frame(target, T_cam_world, (number - late) / RATE, distance) for number in range(count)]
        paths.append(write_video(folder / f"{name}.avi", pictures))
    return paths[0], paths[1]
