"""The first poses, before there is a calibration: facing the cameras, then tilted where the target was."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64
from scipy.spatial.transform import Rotation

from labcal.arrays import Matrix3, Pixels, Pose, Vectors3
from labcal.correspond.detections import Detections
from labcal.geometry.poses import from_rotation_vector
from labcal.guide.next_pose.findable import Findable
from labcal.targets.catalogue import AnyTarget

_WIDTH = 0.5
"""Of the first outline, as a share of the picture's smaller side over that of the target."""
FOCAL = 1.1
"""Guess of a focal length over the picture's width: 49 degrees. It only draws outlines."""
FEWEST = 6
"""Dots of a picture that give a pose."""
FIRST_TILT_DEG = 25.0
"""Of the very first pose: a target that faces a camera would tell no focal length."""


@dataclass(frozen=True)
class FirstPose:
    """A pose in terms of pictures: the target as it was seen first, with an edge tilted away, and words."""

    edge: tuple[float, float]
    """Direction from the middle of the target to what goes away, to the right and down in the picture."""
    tilt_deg: float
    words: str


FIRST_POSES: Sequence[FirstPose] = (
    FirstPose(
        (0.0, -1.0), FIRST_TILT_DEG,
        "Hold the target where you will measure, upright, its top tilted away from the cameras by about 25 "
        "degrees, so that every camera sees all of it, as large as possible",
    ),
    FirstPose((0.0, 1.0), 30.0, "Stay there, and tilt the bottom away from the cameras by about 30 degrees"),
    FirstPose((1.0, 0.0), 35.0, "Stay there, and turn the right side away by about 35 degrees"),
    FirstPose((-0.8, -0.6), 30.0, "Stay there, and tilt the upper left corner away by about 30 degrees"),
    FirstPose((0.8, 0.6), 30.0, "Stay there, and tilt the lower right corner away by about 30 degrees"),
    FirstPose((-1.0, 0.0), 30.0, "Stay there, and turn the left side away by about 30 degrees"),
)  # fmt: skip
"""In their order; begun again where they do not suffice."""


def first_outlines(
    number: int, sizes: Mapping[str, tuple[int, int]], dots: Detections | None, target: AnyTarget
) -> dict[str, Pixels]:
    """Return the outline of a first pose by camera, px.

    Parameters
    ----------
    number : int
        Of the pose, from 0.
    sizes : mapping of str to (int, int)
        Width and height of the pictures by camera, px.
    dots : Detections or None
        Of the first view; None before there is one: then the first camera alone has an outline.
    target : AnyTarget
    """
    findable = Findable.of(target)
    if dots is None or number == 0:
        name, size = next(iter(sizes.items()))
        return {name: _in_the_middle(size, findable)}
    found = {}
    for name, size in sizes.items():
        own = dots.where((dots.camera == name) & dots.has_id & (dots.flag == "ok"))
        if len(own) >= FEWEST:
            found[name] = _tilted(own, size, FIRST_POSES[number % len(FIRST_POSES)], (target, findable))
    return found


def _in_the_middle(size: tuple[int, int], target: Findable) -> Pixels:
    extent = target.extent_mm[1] - target.extent_mm[0]
    focal = FOCAL * size[0]
    distance = focal / (_WIDTH * float(np.min(np.array(size) / extent)))
    R = turned_away(FIRST_POSES[0]) @ np.diag([1.0, -1.0, -1.0])
    p = (target.outline() - target.middle) @ R.T + [0.0, 0.0, distance]
    q = p @ camera_matrix(focal, size).T
    return np.asarray(q[:, :2] / q[:, 2:])


def _tilted(
    own: Detections, size: tuple[int, int], first: FirstPose, of: tuple[AnyTarget, Findable]
) -> Pixels:
    """Return the outline of the target where it was seen in the first view, tilted otherwise."""
    target, findable = of
    K = camera_matrix(FOCAL * size[0], size)
    T = pose_by_pixels(target.points(own.index), own.position, K)
    R, t = T[:3, :3], T[:3, 3]
    held = turned_away(first) @ _facing(R, R @ findable.middle + t)
    p = (findable.outline() - findable.middle) @ held.T + R @ findable.middle + t
    q = p @ K.T
    return np.asarray(q[:, :2] / q[:, 2:])


def _facing(R: Matrix3, place: Vectors3) -> Matrix3:
    """Return a rotation R of a target, turned the shortest way so that the target faces the camera."""
    toward = -place / np.linalg.norm(place)
    across = np.cross(R[:, 2], toward)
    sine = np.linalg.norm(across)
    turn = np.arctan2(sine, R[:, 2] @ toward) * across / max(sine, 1e-12)
    return np.asarray(Rotation.from_rotvec(turn).as_matrix() @ R)


def turned_away(first: FirstPose) -> Matrix3:
    """Return the rotation, in the frame of a camera, that tilts a target which faces it as a pose says."""
    right, down = first.edge
    turn = np.radians(first.tilt_deg) * np.array([down, -right, 0.0]) / np.hypot(right, down)
    return np.asarray(Rotation.from_rotvec(turn).as_matrix())


def camera_matrix(focal: float, size: tuple[int, int]) -> Matrix3:
    """Return K of a focal length (px) about the middle of a picture."""
    return np.array([[focal, 0.0, 0.5 * (size[0] - 1)], [0.0, focal, 0.5 * (size[1] - 1)], [0.0, 0.0, 1.0]])


def pose_by_pixels(points: Float64[np.ndarray, "n 3"], q: Pixels, K: Float64[np.ndarray, "3 3"]) -> Pose:
    """Return ``T_cam_target`` (mm) of flat points, (n, 3), by their pixels without distortion, (n, 2)."""
    p, pixels = np.ascontiguousarray(points), np.ascontiguousarray(q)
    _, turn, shift = cv2.solvePnP(p, pixels, K, None, flags=cv2.SOLVEPNP_IPPE)
    return from_rotation_vector(np.ravel(turn), np.ravel(shift))
