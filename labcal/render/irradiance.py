"""One picture's light, linear and free of sensor noise: passes and bands put together."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.render.laboratory import Laboratory, Passes
from labcal.rng import integer_seed
from labcal.scene.model import samples_per_pass


@dataclass(frozen=True)
class Case:
    """One picture to be rendered."""

    view: str
    camera: str
    T_world_target: Pose
    seed: int
    """Seed of the whole run."""


def render_light(laboratory: Laboratory, camera: Camera, case: Case) -> np.ndarray:
    """Return the radiance that each pixel of a picture receives.

    Passes are added in a fixed order, so that the bytes are the same each time.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        float32, in the unit of the scene's lamps.
    """
    height = camera.size[1]
    spp = laboratory.description.spp
    samples = samples_per_pass(spp)
    rows = laboratory.band_rows
    laboratory.place(case.T_world_target)
    sensor = laboratory.sensor(camera)
    seed = integer_seed(case.seed, case.view, case.camera)
    bands = []
    for first_row in range(0, height, rows):
        total: np.ndarray | None = None
        for first in range(0, spp, samples):
            band = laboratory.trace(sensor, first_row, Passes(seed, spp, first, samples))
            total = band if total is None else total + band
        bands.append(np.asarray(total) / np.float32(spp // samples))
    return np.concatenate(bands)[:height]
