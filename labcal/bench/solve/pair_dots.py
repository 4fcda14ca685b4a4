"""Dots of a held target as a simulated pair of cameras measures them: images of centres with noise."""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import Pose, Vectors3
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.targets.grid import DotGrid

CAMERAS = ("left", "right")


def pair_dots(
    cameras: Sequence[Camera],
    target: DotGrid,
    dots: Vectors3,
    views: Sequence[Pose],
    noise: tuple[float, np.random.Generator],
) -> Detections:
    """Return the dots of all views in both cameras.

    Parameters
    ----------
    cameras : sequence of Camera
        Two of one picture size.
    target : DotGrid
    dots : ndarray, shape (dots, 3)
        Places on the print, mm.
    views : sequence of ndarray, shape (4, 4)
        ``T_world_target``, mm.
    noise : (float, numpy.random.Generator)
        Standard deviation along each axis, px, and where it comes from.
    """
    noise_px, random = noise
    places = [dots @ T[:3, :3].T + T[:3, 3] for T in views]
    q = np.concatenate([camera.project(p).q for camera in cameras for p in places])
    n = len(q)
    names = np.repeat([f"view-{number:02d}" for number in range(len(views))], len(dots))
    return Detections(
        view=np.tile(names, 2),
        camera=np.repeat(CAMERAS, n // 2),
        image=np.full(n, "none.png"),
        size=np.tile(cameras[0].size, (n, 1)),
        index=np.tile(target.indices(), (2 * len(views), 1)),
        has_id=np.ones(n, dtype=bool),
        position=q + noise_px * random.standard_normal(q.shape),
        covariance=np.tile(noise_px**2 * np.eye(2), (n, 1, 1)),
        flag=np.full(n, "ok"),
    )
