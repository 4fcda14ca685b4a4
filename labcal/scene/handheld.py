"""Poses of a target in the hand: drawn at random, kept where every camera sees what it needs."""

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.errors import InputError
from labcal.geometry.poses import pose, transform
from labcal.rng import generator
from labcal.scene.model import Scene
from labcal.scene.placement import Handheld
from labcal.targets.grid import DotGrid

TRIES_PER_VIEW = 100
SHARE_VISIBLE = 0.6
"""Share of the dots that every camera must see whole."""


def handheld_poses(scene: Scene, seed: int) -> list[Pose]:
    """Draw ``T_world_target`` (mm) of every view of a scene with a hand-held target.

    Places are spread evenly over the scene's box and tilts over the disc of allowed ones. A pose is kept if
    every camera sees all three rings and at least 60% of the dots whole.

    Raises
    ------
    InputError
        The scene's target is not hand-held, or too few poses pass.
    """
    placement = scene.placement
    if not isinstance(placement, Handheld):
        raise InputError(f"The target of the scene '{scene.name}' is not hand-held.")
    cameras = list(scene.true_cameras().values())
    eyes = np.mean([camera.centre for camera in cameras], axis=0)
    right = cameras[0].T_cam_world[0, :3].copy()
    random = generator(seed, "hand-held poses")
    wanted = placement.train + placement.test
    poses: list[Pose] = []
    for _ in range(TRIES_PER_VIEW * wanted):
        T_world_target = _draw(placement, scene.target, (eyes, right), random)
        if all(_sees_enough(camera, T_world_target, scene.target) for camera in cameras):
            poses.append(T_world_target)
        if len(poses) == wanted:
            return poses
    raise InputError(
        f"Only {len(poses)} of {wanted} hand-held poses of the scene '{scene.name}' show all rings to all "
        "cameras. Move placement.centre_mm away from the cameras, or lessen spread_mm or tilt_max_deg."
    )


def _draw(
    placement: Handheld,
    target: DotGrid,
    viewer: tuple[np.ndarray, np.ndarray],
    random: np.random.Generator,
) -> Pose:
    """Draw one pose about the line to the cameras; `viewer` is their middle and the pictures' right."""
    eyes, right = viewer
    middle = np.array(placement.centre_mm) + np.array(placement.spread_mm) * random.uniform(-1.0, 1.0, 3)
    towards = (eyes - middle) / np.linalg.norm(eyes - middle)
    x = right - (right @ towards) * towards
    x /= np.linalg.norm(x)
    facing = np.stack([x, np.cross(towards, x), towards], axis=1)
    tilt = np.radians(placement.tilt_max_deg) * np.sqrt(random.uniform())
    azimuth = random.uniform(-np.pi, np.pi)
    roll = np.radians(placement.roll_max_deg) * random.uniform(-1.0, 1.0)
    tilted = Rotation.from_rotvec(tilt * np.array([np.cos(azimuth), np.sin(azimuth), 0.0]))
    R_world_target = facing @ tilted.as_matrix() @ Rotation.from_rotvec([0.0, 0.0, roll]).as_matrix()
    return pose(R_world_target, middle - R_world_target @ target.points().mean(axis=0))


def _sees_enough(camera: Camera, T_world_target: Pose, target: DotGrid) -> bool:
    """Return whether the camera sees the rings and most dots whole, from the front."""
    if float((camera.centre - T_world_target[:3, 3]) @ T_world_target[:3, 2]) <= 0.0:
        return False
    middles = camera.project(transform(T_world_target, target.points(np.array(target.ring_indices))))
    if not camera.in_picture(middles.q).all():  # spares the outlines of most poses that fail
        return False
    images = dot_images(camera, T_world_target, target.points(), 0.5 * target.outer_diameters_mm())
    visible = images.ok & camera.in_picture(images.outline).all(axis=-1)
    rings = [row * target.cols + col for col, row in target.ring_indices]
    return bool(visible[rings].all() and visible.mean() >= SHARE_VISIBLE)
