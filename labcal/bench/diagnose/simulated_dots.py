"""Dots of a simulated shoot as the detector would measure them: centroids with noise by their size."""

import numpy as np

from labcal.bench.diagnose.held_shoot import HeldShoot, Picture
from labcal.cameras.dot_image import dot_images
from labcal.correspond.detections import Detections
from labcal.guide.rehearsal.dot_noise import minor_semi_axes

_USUAL_PX = 8.0
"""Minor semi-axis of dots that have the noise of the shoot."""
_POWER = -1.5
"""Of the variance by the size, as in :mod:`labcal.guide.rehearsal.dot_noise`."""


def simulated_dots(shoot: HeldShoot, random: np.random.Generator) -> Detections:
    """Return the dots of all pictures; of a rolling shutter each where it is when its row is read.

    Parameters
    ----------
    shoot : HeldShoot
    random : numpy.random.Generator
    """
    radii = 0.5 * shoot.printed.outer_diameters_mm()
    index = shoot.printed.indices()
    parts = []
    for picture in shoot.pictures:
        q, size = _images(shoot, picture, radii)
        seen = np.isfinite(q).all(axis=1) & picture.device.in_picture(q)
        variance = shoot.noise_px**2 * (size[seen] / _USUAL_PX) ** _POWER
        noise = np.sqrt(variance)[:, None] * random.standard_normal((int(seen.sum()), 2))
        parts.append((picture, q[seen] + noise, variance, index[seen]))
    counts = [len(q) for _, q, _, _ in parts]
    return Detections(
        view=np.repeat([picture.view for picture, *_ in parts], counts),
        camera=np.repeat([picture.camera for picture, *_ in parts], counts),
        image=np.repeat([f"{one.view}_{one.camera}.png" for one, *_ in parts], counts),
        size=np.repeat([one.device.size for one, *_ in parts], counts, axis=0),
        index=np.concatenate([part[3] for part in parts]),
        has_id=np.ones(sum(counts), dtype=bool),
        position=np.concatenate([part[1] for part in parts]),
        covariance=np.concatenate([part[2] for part in parts])[:, None, None] * np.eye(2),
        flag=np.full(sum(counts), "ok"),
    )


def _images(shoot: HeldShoot, picture: Picture, radii: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the centroids and minor semi-axes of all dots, px."""
    camera, T = picture.device, picture.T_world_target
    images = dot_images(camera, T, shoot.dots, radii)
    q = np.where(images.ok[:, None], images.centroid, np.nan)
    if picture.drift_mm.any():
        share = q[:, 1] / camera.size[1] - 0.5
        # To first order in the drift between neighbouring rows: the time at which a row is read.
        moved = shoot.dots @ T[:3, :3].T + T[:3, 3] + share[:, None] * picture.drift_mm
        q = q + camera.project(moved).q - camera.project(shoot.dots @ T[:3, :3].T + T[:3, 3]).q
    return q, minor_semi_axes(images.outline)
