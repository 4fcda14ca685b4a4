"""Small made-up data to try things on: a rig, the dots that it sees, and where they are.

Nothing is rendered or detected, so that all of it is there at once; every call gives the same numbers. The
examples of the documentation start from these.
"""

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.points import Points
from labcal.geometry.poses import from_rotation_vector, pose
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.rng import generator
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

SIGMA_PX = 0.02
"""Standard deviation of the dots' positions along each axis."""
TARGET = "plain-11x8"
_VIEWS = 8
_SIZE = (640, 480)
_TILT_RAD = 0.45
_DISTANCE_MM = 550.0


def rig() -> Rig:
    """Return a rig of two cameras, 200 mm apart and turned towards each other; the left one is the world.

    Examples
    --------
    >>> list(rig().cameras)
    ['left', 'right']
    """
    left = Camera(
        [[800.0, 0.0, 322.0], [0.0, 800.0, 238.0], [0.0, 0.0, 1.0]], "brown5",
        [-0.12, 0.05, 3e-4, -2e-4, 0.0], np.eye(4), _SIZE,
    )  # fmt: skip
    towards = from_rotation_vector(np.array([0.0, 0.3, 0.0]), np.zeros(3))[:3, :3]
    right = Camera(
        [[805.0, 0.0, 318.0], [0.0, 805.0, 241.0], [0.0, 0.0, 1.0]], "brown5",
        [-0.11, 0.04, -2e-4, 3e-4, 0.0], pose(towards, -towards @ [200.0, 0.0, 0.0]), _SIZE,
    )  # fmt: skip
    return Rig.of({"left": left, "right": right})


def detections() -> Detections:
    """Return the dots of the target :data:`TARGET`, held in eight places before :func:`rig`.

    Positions are centroids with normal noise of :data:`SIGMA_PX`; dots that are not wholly in the picture are
    flagged ``cut``.

    Examples
    --------
    >>> detections().views[:3]
    ('hand-0', 'hand-1', 'hand-2')
    """
    target, cameras = load_target(TARGET), rig()
    assert isinstance(target, DotGrid)  # noqa: S101 -- for the checker of types
    rng = generator(0, "examples")
    centres, radii, n = target.points(), 0.5 * target.outer_diameters_mm(), target.count
    parts: list[tuple[str, str, np.ndarray, np.ndarray]] = []
    for number in range(_VIEWS):
        T_world_target = _held(number, centres.mean(axis=0))
        for name in cameras.cameras:
            camera = cameras.camera(name)
            seen = dot_images(camera, T_world_target, centres, radii)
            whole = seen.ok & camera.in_picture(seen.outline).all(axis=-1)
            parts.append((f"hand-{number}", name, whole, seen.centroid + rng.normal(0.0, SIGMA_PX, (n, 2))))
    whole = np.concatenate([part[2] for part in parts])
    position = np.concatenate([part[3] for part in parts])
    return Detections(
        view=np.repeat([part[0] for part in parts], n),
        camera=np.repeat([part[1] for part in parts], n),
        image=np.repeat([f"{part[0]}_{part[1]}.png" for part in parts], n),
        size=np.tile(_SIZE, (len(position), 1)),
        index=np.tile(target.indices(), (len(parts), 1)),
        has_id=np.ones(len(position), dtype=bool),
        position=np.where(whole[:, None], position, np.nan),
        covariance=np.where(whole[:, None, None], SIGMA_PX**2 * np.eye(2), np.nan),
        flag=np.where(whole, "ok", "cut"),
    )


def points() -> Points:
    """Return the points that :func:`rig` reconstructs from :func:`detections`.

    Examples
    --------
    >>> points().point.shape[1]
    3
    """
    return reconstruct_points(rig(), detections(), load_target(TARGET))


def _held(number: int, middle: np.ndarray) -> Pose:
    """Return the pose of a target in the hand, tilted another way each time."""
    around = 2.0 * np.pi * number / _VIEWS
    tilt = from_rotation_vector(_TILT_RAD * np.array([np.cos(around), np.sin(around), 0.0]), np.zeros(3))
    R = np.diag([1.0, -1.0, -1.0]) @ tilt[:3, :3]
    place = [25.0 + 60.0 * np.cos(2.0 * around), 50.0 * np.sin(2.0 * around), _DISTANCE_MM + 25.0 * number]
    return pose(R, place - R @ middle)
