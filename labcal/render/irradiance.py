"""One picture's light, linear and free of sensor noise: passes, bands and sub-frames put together."""

import math
from dataclasses import dataclass

import numpy as np

from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Laboratory
from labcal.rng import integer_seed
from labcal.scene.model import least_samples, samples_per_pass
from labcal.scene.subframes import Subframes, subframes
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
        """Name of the camera that takes the picture, whatever name it is delivered under."""
        return self.take.taken_by


def render_light(laboratories: Laboratories, case: Case) -> np.ndarray:
    """Return the radiance that each pixel of a picture receives, on average over its exposure.

    Everything is added in a fixed order, so that the bytes are the same each time. The rays a pixel are
    shared among the sub-frames of a moving target, each having at least one, so that no row has more noise
    than a still picture's.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        float32, in the unit of the scene's lamps.
    """
    scene, camera = laboratories.scene, case.take.device
    width, height = camera.size
    frames = subframes(case.take, scene.target)
    samples = least_samples(scene.spp / frames.averaged)
    laboratory = laboratories.of_size((width, _film_rows(frames, height)))
    light = np.zeros((height, width, 3) if laboratory.colour else (height, width), dtype=np.float32)
    for number, seconds in enumerate(frames.seconds):
        laboratory.place(case.take.track.at(float(seconds)))
        first, end = frames.rows(number)
        for top in range(first, end, laboratory.band_rows):
            rows = slice(top, min(top + laboratory.band_rows, end))
            names = (f"row {top}",) if len(frames.seconds) == 1 else (f"sub-frame {number}", f"row {top}")
            band = _band(laboratory, case, top, samples, names)[: rows.stop - top]
            band *= frames.weights[number, rows].astype(np.float32).reshape(-1, *(1,) * (band.ndim - 1))
            light[rows] += band
    return light


def _band(
    laboratory: Laboratory, case: Case, first_row: int, samples: int, names: tuple[str, ...]
) -> np.ndarray:
    """Return a band of rows of a still picture: the mean of its passes; `names` name its random numbers."""
    each = samples_per_pass(samples)
    passes = samples // each
    total: np.ndarray | None = None
    for number in range(passes):
        seed = integer_seed(case.seed, case.view, case.camera, *names, f"pass {number}")
        band = laboratory.trace(case.take.device, first_row, each, seed)
        total = band if total is None else total + band
    return np.asarray(total) / np.float32(passes)


def _film_rows(frames: Subframes, height: int) -> int:
    """Return a height of film that holds what any sub-frame shows, of a few that all pictures share."""
    ranges = [frames.rows(number) for number in range(len(frames.seconds))]
    needed = max(end - first for first, end in ranges)
    step = 1 << max(0, needed.bit_length() - 3)  # four heights an octave
    return min(height, step * math.ceil(needed / step))
