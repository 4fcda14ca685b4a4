"""A target in front of one camera, with its dots projected by the camera model; no picture is rendered."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial.transform import Rotation

from labcal.arrays import Mask, Pixels, Pose
from labcal.cameras.camera import Camera
from labcal.cameras.dot_image import dot_images
from labcal.correspond.detections import Detections
from labcal.geometry.poses import pose
from labcal.targets.grid import DotGrid

CAMERA = "only"
"""Name of the one camera."""


@dataclass(frozen=True)
class HandViews:
    """Range of poses of a hand-held target."""

    views: int
    tilt_deg: float
    """Tilts run evenly up to this, about axes all around."""
    radius_px: float
    """Of a dot in the middle of the picture that faces the camera, at the nearest."""


def poses_in_hand(
    camera: Camera, target: DotGrid, wanted: HandViews, random: np.random.Generator
) -> list[Pose]:
    """Return ``T_cam_target`` of views in which the whole target is in the picture.

    Parameters
    ----------
    camera : Camera
        Its frame is the world.
    target : DotGrid
    wanted : HandViews
    random : numpy.random.Generator
    """
    middle = target.points().mean(axis=0)
    distance = camera.K[0, 0] * 0.5 * target.dot_diameter_mm / wanted.radius_px
    poses: list[Pose] = []
    for number in range(wanted.views):
        tilt = np.radians(wanted.tilt_deg) * (number + 0.5) / wanted.views
        while len(poses) == number:
            azimuth, roll = random.uniform(0.0, 2.0 * np.pi, 2)
            axis = np.array([np.cos(azimuth), np.sin(azimuth), 0.0])
            turn = Rotation.from_rotvec(tilt * axis) * Rotation.from_rotvec([0.0, 0.0, roll])
            R = np.diag([1.0, -1.0, -1.0]) @ turn.as_matrix()
            at = np.array([0.0, 0.0, distance * random.uniform(1.0, 1.25)])
            at[:2] = 0.1 * distance * random.uniform(-1.0, 1.0, 2)
            T = pose(R, at - R @ middle)
            found = dot_images(camera, T, target.points(), 0.5 * target.outer_diameters_mm())
            if found.ok.all() and camera.in_picture(found.outline).all():
                poses.append(T)
    return poses


def dots_at(
    q: Sequence[Pixels], ok: Sequence[Mask], target: DotGrid, size: tuple[int, int], noise_px: float
) -> Detections:
    """Return detections of the camera :data:`CAMERA` at pixels, by view.

    Parameters
    ----------
    q : sequence of ndarray, each of shape (count, 2)
        Where each view's dots are, px.
    ok : sequence of ndarray of bool
        Which of them are measured.
    target : DotGrid
    size : (int, int)
        Of the pictures, px.
    noise_px : float
        Standard deviation along each axis.
    """
    n = len(q) * target.count
    return Detections(
        view=np.repeat([f"view-{number:02d}" for number in range(len(q))], target.count),
        camera=np.full(n, CAMERA),
        image=np.repeat([f"view-{number:02d}.png" for number in range(len(q))], target.count),
        size=np.tile(np.array(size, dtype=np.int64), (n, 1)),
        index=np.tile(target.indices().astype(np.int64), (len(q), 1)),
        has_id=np.ones(n, dtype=bool),
        position=np.concatenate(q),
        covariance=np.tile(noise_px**2 * np.eye(2), (n, 1, 1)),
        flag=np.where(np.concatenate(ok), "ok", "cut"),
    )
