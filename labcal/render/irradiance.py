"""The light of one picture, linear, without sensor noise: the sum of bands of rows and sub-frames."""

import math
from dataclasses import dataclass

import numpy as np

from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw
from labcal.rng import integer_seed
from labcal.scene.subframes import subframes
from labcal.scene.take import Take


@dataclass(frozen=True)
class Case:
    """One picture to be rendered."""

    take: Take
    seed: int
    """Seed of the whole run."""

    @property
    def view(self) -> str:
        """Name of the view."""
        return self.take.view

    @property
    def camera(self) -> str:
        """Name of the camera that takes the picture, which may differ from the delivered name."""
        return self.take.taken_by


def render_light(laboratories: Laboratories, case: Case) -> np.ndarray:
    """Return the radiance at each pixel of a picture, the mean over its exposure.

    Everything is added in a fixed order, so that the bytes are the same each time. The rays a pixel are
    shared among the sub-frames of a moving target, each having at least one, so that no row has more noise
    than a still picture's.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        float32, in the unit of the scene's lamps.
    """
    scene, camera = laboratories.scene, case.take.device
    frames = subframes(case.take, scene.target)
    count = math.ceil(scene.spp / frames.averaged)
    laboratory = laboratories.of_size(camera.size)
    rays = laboratory.rays_of(camera, scene.cameras[case.camera].aperture)
    seed = integer_seed(case.seed, case.view, case.camera)
    light = np.zeros(laboratory.shape, dtype=np.float32)
    for number, seconds in enumerate(frames.seconds):
        laboratory.place(case.take.track.at(float(seconds)))
        draw = Draw(seed, count * len(frames.seconds), count * number, count)
        first, end = frames.rows(number)
        step = laboratory.rows_at_once(count)
        for top in range(first, end, step):
            rows = slice(top, min(top + step, end))
            weight = frames.weights[number, rows].astype(np.float32).reshape(-1, *(1,) * (light.ndim - 1))
            light[rows] += weight * laboratory.trace(rays, rows, draw)
    return light
