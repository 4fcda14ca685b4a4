"""The light of one picture behind the lens, linear and noise-free: the sum of bands and sub-frames."""

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from labcal.render.bands import ROWS, strips
from labcal.render.camera_rays import CameraRays
from labcal.render.film import CELLS_AT_ONCE, Film, Places, Shading, shade, traced_cells
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw, Laboratory
from labcal.render.point_spread import finer, reach
from labcal.rng import integer_seed
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
        """Name of the camera that takes the picture, which may differ from the delivered name."""
        return self.take.taken_by


def render_light(laboratories: Laboratories, case: Case, shading: Shading | None = None) -> np.ndarray:
    """Return the light that each pixel of a picture gathers, the mean over its exposure.

    The lens blurs the light before the pixels gather it. Everything is added in a fixed order, so that the
    bytes are the same each time. The rays a pixel are shared among the sub-frames of a moving target, each
    having at least one, so that no row has more noise than a still picture's.

    Parameters
    ----------
    laboratories : Laboratories
    case : Case
    shading : callable, optional
        What the lens lets through where, before it blurs; all of it where there is none.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        float32, radiance in the unit of the scene's lamps.
    """
    scene, camera = laboratories.scene, case.take.device
    laboratory = laboratories.of_size(camera.size)
    frames = subframes(case.take, scene.target)
    exposing = _Exposing(
        laboratory=laboratory,
        rays=laboratory.rays_of(camera, scene.cameras[case.camera].aperture),
        case=case,
        frames=frames,
        count=math.ceil(scene.spp / frames.averaged),
        shading=shading,
    )
    blur_px = case.take.photometry(scene.photometry).blur_px
    return exposing.sharp() if blur_px == 0.0 else exposing.blurred(blur_px)


@dataclass(frozen=True)
class _Exposing:
    """The tracing of one picture."""

    laboratory: Laboratory
    rays: CameraRays
    case: Case
    frames: Subframes
    count: int
    """Rays a pixel of each sub-frame."""
    shading: Shading | None

    def sharp(self) -> np.ndarray:
        """Return the mean radiance of each pixel."""
        light = np.zeros(self.laboratory.shape, dtype=np.float32)
        for number, part, draw in self._parts(range(len(light))):
            rows = slice(part.start, part.stop)
            weight = self.frames.weights[number, rows].astype(np.float32)
            traced = self.laboratory.trace(self.rays, rows, draw)
            light[rows] += weight.reshape(-1, *(1,) * (light.ndim - 1)) * traced
        if self.shading is not None:
            shade(light[None, :, :, None], (0, 0), self.shading)
        return light

    def blurred(self, blur_px: float) -> np.ndarray:
        """Return the light that pixels gather behind a point spread, from films of some rows each."""
        light = np.zeros(self.laboratory.shape, dtype=np.float32)
        height, width, *channels = light.shape
        cells, halo = finer(blur_px, self.count), reach(blur_px)
        step = max(ROWS, CELLS_AT_ONCE // (width * cells**2 * math.prod(channels)))
        for own, wide in strips(height, step, halo):
            even = self.count % cells**2 == 0
            film = Film(len(wide), width + 2 * halo, cells, tuple(channels), even=even)
            for number, rows, draw in self._parts(wide):
                pixels = Places.around(rows, self.case.take.device, halo)
                traced = traced_cells(self.laboratory, self.rays, pixels, draw, cells)
                weight = self.frames.weights[number, np.clip(rows, 0, height - 1)].astype(np.float32)
                film.add(slice(rows.start - wide.start, rows.stop - wide.start), weight, traced)
            if self.shading is not None:
                shade(film.light, (-halo, wide.start), self.shading)
            light[own] = film.gathered(blur_px)[halo:-halo, halo:-halo]
        return light

    def _parts(self, within: range) -> Iterator[tuple[int, range, Draw]]:
        """Yield what is traced at once: number of the sub-frame (placed), rows, and samples.

        Rows beyond the picture are exposed with the one next to them.
        """
        seed = integer_seed(self.case.seed, self.case.view, self.case.camera)
        height = self.frames.weights.shape[1]
        for number, seconds in enumerate(self.frames.seconds):
            first, end = self.frames.rows(number)
            first = within.start if first == 0 else max(first, within.start)
            end = within.stop if end == height else min(end, within.stop)
            if first >= end:
                continue
            self.laboratory.place(self.case.take.track.at(float(seconds)))
            draw = Draw(seed, self.count * len(self.frames.seconds), self.count * number, self.count)
            step = self.laboratory.rows_at_once(self.count)
            for top in range(first, end, step):
                yield number, range(top, min(top + step, end)), draw
