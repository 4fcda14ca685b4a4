"""The share of each pixel that shows the lighter of a print's two colours: geometry alone, sharp.

Edges are traced with many rays, since what the light, the blur and the noise make of them is added afterwards
and compared with a photograph; where a pixel and all its neighbours show one colour, a few rays tell it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from types import ModuleType

import cv2
import numpy as np
from jaxtyping import Float32, Int64

from labcal.render.bands import ROWS, strips
from labcal.render.camera_rays import CameraRays
from labcal.render.film import CELLS_AT_ONCE, Cells, Film, Places, traced_cells
from labcal.render.irradiance import Case
from labcal.render.laboratories import Laboratories
from labcal.render.laboratory import Draw, Laboratory
from labcal.render.point_spread import finer, gathered_variance, reach
from labcal.render.variant import MONO, renderer
from labcal.rng import integer_seed
from labcal.scene.model import Scene

FEW = 4
"""Rays of every pixel; they find the edges."""
_SAME = 1e-6
_BESIDE = 3
"""Side of the neighbourhood of a pixel in which an edge may be."""


@dataclass(frozen=True)
class SharpShare:
    """A share of paper in front of the lens's blur: pixels, and the cells of those at edges.

    Attributes
    ----------
    pixels : float32 array, (h, w)
        0 to 1.
    at : int array, (n,)
        Numbers of the pixels at edges, row by row.
    cells : Cells
        Of those pixels.
    """

    pixels: Float32[np.ndarray, "h w"]
    at: Int64[np.ndarray, " n"]
    cells: Cells

    @classmethod
    def of(
        cls, pixels: Float32[np.ndarray, "h w"], at: Int64[np.ndarray, " n"], cells: Cells
    ) -> "SharpShare":
        """Return a share whose pixels at edges are the means of their cells."""
        whole = pixels.copy()
        light = cells.light.mean(axis=(1, 2))
        whole.reshape(-1)[at] = light if cells.rays is None else light / cells.rays.mean(axis=(1, 2))
        return cls(whole, at, cells)

    def behind(self, blur_px: float) -> Float32[np.ndarray, "h w"]:
        """Return the share that pixels gather behind a point spread (standard deviation, px)."""
        seen = np.empty_like(self.pixels)
        for own, film in self._films(self.pixels, self.cells, blur_px):
            seen[own[0]] = film.gathered(blur_px)[own[1]]
        return seen

    def variance_behind(self, variance: Float32[np.ndarray, "n k k"], blur_px: float) -> np.ndarray:
        """Return the variance behind a point spread, (h, w), from that of the cells at edges alone."""
        seen = np.empty_like(self.pixels)
        for own, film in self._films(np.zeros_like(self.pixels), Cells(variance, None), blur_px):
            seen[own[0]] = gathered_variance(film.light, blur_px)[own[1]]
        return seen

    def of_cells(self, finer: int) -> Float32[np.ndarray, "n j j"]:
        """Return the shares in cells at edges as fine as these or coarser; NaN in one without a ray."""
        n, own = len(self.at), self.cells.finer
        light, rays = (
            None if part is None else part.reshape(n, finer, own // finer, finer, own // finer).mean((2, 4))
            for part in (self.cells.light, self.cells.rays)
        )
        with np.errstate(invalid="ignore"):
            return np.asarray(light if rays is None else light / rays)

    def _films(
        self, pixels: Float32[np.ndarray, "h w"], cells: Cells, blur_px: float
    ) -> Iterator[tuple[tuple[slice, slice], Film]]:
        """Yield rows, and where they are in the films of some rows more; pixels away from edges are even."""
        height, width = pixels.shape
        rows = max(ROWS, CELLS_AT_ONCE // (width * cells.finer**2))
        for own, around in strips(height, rows, reach(blur_px)):
            wide = slice(max(0, around.start), min(around.stop, height))
            film = Film(wide.stop - wide.start, width, cells.finer, (), even=cells.rays is None)
            film.light[:] = pixels[wide][None, :, :, None]
            first, last = np.searchsorted(self.at, [wide.start * width, wide.stop * width])
            row, column = np.divmod(self.at[first:last] - wide.start * width, width)
            film.light[:, row, column] = np.moveaxis(cells.light[first:last], 1, 0)
            if film.rays is not None and cells.rays is not None:
                film.rays[:] = 1.0
                film.rays[:, row, column] = np.moveaxis(cells.rays[first:last], 1, 0)
            yield (own, slice(own.start - wide.start, own.stop - wide.start)), film


@dataclass(frozen=True)
class PaperShare:
    """The share of paper in a picture.

    Attributes
    ----------
    share : SharpShare
    rough : tuple of SharpShare
        The same share with fewer rays, as often as it was asked for.
    """

    share: SharpShare
    rough: tuple[SharpShare, ...] = ()


@dataclass(frozen=True)
class EdgeRays:
    """Rays of pixels at edges.

    Attributes
    ----------
    spp : int
        Of the share itself.
    rough_spp, rough : int
        Rays of further, rougher shares, and how many of these are wanted.
    """

    spp: int
    rough_spp: int = 1
    rough: int = 0


def paper_share(scene: Scene, case: Case, wanted: EdgeRays) -> PaperShare:
    """Render the share of the paper in each pixel of a picture.

    Parameters
    ----------
    scene : Scene
        With ambient light of radiance 1, paper of reflectance 1 and ink of 0: light is then the share.
    case : Case
        A picture of a target that stands still.
    wanted : EdgeRays

    Raises
    ------
    DeviceError
        The renderer does not work on this machine.
    """
    with renderer(MONO) as mi:
        laboratory, rays = _placed(mi, scene, case)
        width, height = case.take.device.size
        seed = integer_seed(case.seed, case.view, case.camera)
        pixels = np.zeros((height, width), dtype=np.float32)
        step = laboratory.rows_at_once(FEW)
        for top in range(0, height, step):
            rows = slice(top, min(top + step, height))
            pixels[rows] = laboratory.trace(rays, rows, Draw(seed, FEW, 0, FEW))
        around = np.ones((_BESIDE, _BESIDE), dtype=np.uint8)
        edges = cv2.dilate(pixels, around) - cv2.erode(pixels, around) > _SAME
        at = np.flatnonzero(edges)
        draw, most = Draw(seed, wanted.spp, 0, wanted.spp), max(wanted.spp, wanted.rough_spp)
        places = Places.of(at, width)
        share = SharpShare.of(pixels, at, traced_cells(laboratory, rays, places, draw, finer(0.0, most)))
        rough = []
        for number in range(wanted.rough):
            other = integer_seed(case.seed, case.view, case.camera, f"rough {number}")
            draw = Draw(other, wanted.rough_spp, 0, wanted.rough_spp)
            cells = traced_cells(laboratory, rays, places, draw, finer(0.0, wanted.rough_spp))
            rough.append(SharpShare.of(pixels, at, cells))
    return PaperShare(share, tuple(rough))


def _placed(mi: ModuleType, scene: Scene, case: Case) -> tuple[Laboratory, CameraRays]:
    """Return the laboratory with the target in place, and the rays of the camera."""
    camera = case.take.device
    laboratory = Laboratories(mi, scene, case.seed).of_size(camera.size)
    laboratory.place(case.take.track.at(0.0))
    return laboratory, laboratory.rays_of(camera)
