"""The film of a picture: light in cells that are finer than pixels, before the lens blurs it."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32

from labcal.arrays import Pixels
from labcal.cameras.camera import Camera
from labcal.render.laboratory import PIXEL, RAYS_AT_ONCE, Draw, Laboratory, Rays
from labcal.render.point_spread import gathered
from labcal.render.samples import Samples
from labcal.render.variant import Jit

CELLS_AT_ONCE = 2**26
"""No film has more cells, times colours, which bounds the memory."""
Shading = Callable[[Pixels], np.ndarray]
"""Share of the light that reaches places (..., 2) of the picture, px, as behind a graduated filter."""


@dataclass(frozen=True)
class Cells:
    """The light in the cells of pixels.

    Attributes
    ----------
    light : float32 array, (n, k, k) or (n, k, k, 3)
        Sum of the radiance of the rays of each cell, by row and column in its pixel, over the mean number of
        rays of a cell.
    rays : float32 array, (n, k, k), or None
        Rays of each cell over their mean number; None where each has as many.
    """

    light: Float32[np.ndarray, "n k k *channels"]
    rays: Float32[np.ndarray, "n k k"] | None

    @property
    def finer(self) -> int:
        """Cells along a side of a pixel."""
        return int(self.light.shape[1])


@dataclass(frozen=True)
class Places:
    """Pixels that are traced, in the picture or beyond it, from where a blur spreads light into it.

    Attributes
    ----------
    number : int array, (n,)
        For which rays are drawn: those of the picture's own pixels count row by row, further ones go on.
    column, row : int array, (n,)
        Of the picture.
    """

    number: np.ndarray
    column: np.ndarray
    row: np.ndarray

    @classmethod
    def of(cls, number: np.ndarray, width: int) -> "Places":
        """Return pixels of a picture by their numbers."""
        row, column = np.divmod(number, width)
        return cls(number, column, row)

    @classmethod
    def around(cls, rows: range, camera: Camera, halo: int) -> "Places":
        """Return the pixels of some rows, each with `halo` more on both sides.

        Beyond the picture, where the lens has no ray or its formula is not meant to hold, a pixel is that of
        the picture next to it.
        """
        (width, height), (fx, fy, cx, cy) = camera.size, camera.intrinsics
        row, column = (part.ravel() for part in np.mgrid[rows.start : rows.stop, -halo : width + halo])
        inside = np.clip(column, 0, width - 1), np.clip(row, 0, height - 1)
        beyond = np.flatnonzero((column != inside[0]) | (row != inside[1]))
        number = row * width + column
        number[beyond] = width * height + (row[beyond] + halo) * (width + 2 * halo) + column[beyond] + halo
        q = np.stack([column[beyond], row[beyond]], axis=-1).astype(np.float64)
        radius = np.hypot(*((q - [cx, cy]) / [fx, fy]).T)
        dark = beyond[~camera.rays(q).ok | (radius > camera.reach)]
        for own, within in ((column, inside[0]), (row, inside[1])):
            own[dark] = within[dark]
        return cls(number, column, row)


class Film:
    """The light in the cells of some rows of a picture, and of what is around them.

    Where cells have different numbers of rays, a pixel is the light that it gathers over the rays that it
    gathers.

    Parameters
    ----------
    rows, width : int
        Pixels.
    finer : int
        Cells along a side of a pixel.
    channels : tuple of int
        () or (3,).
    even : bool
        True if all cells have the same number of rays.
    """

    def __init__(self, rows: int, width: int, finer: int, channels: tuple[int, ...], *, even: bool) -> None:
        self._shape = (finer, rows, width, finer)
        self.light = np.zeros((*self._shape, *channels), dtype=np.float32)
        self.rays = None if even else np.zeros(self._shape, dtype=np.float32)

    def add(self, rows: slice, weight: Float32[np.ndarray, " rows"], cells: Cells) -> None:
        """Add what was traced of some rows, each with a weight."""
        finer, _, width, _ = self._shape
        times = weight.reshape(1, -1, 1, 1)
        for into, of in ((self.light, cells.light), (self.rays, cells.rays)):
            if into is not None and of is not None:
                apart = np.moveaxis(of.reshape(len(weight), width, finer, *of.shape[2:]), 2, 0)
                into[:, rows] += times.reshape(*times.shape, *(1,) * (of.ndim - 3)) * apart

    def gathered(self, blur_px: float) -> np.ndarray:
        """Return the light of pixels behind a blur, shape (rows, width) or (rows, width, 3)."""
        light = gathered(self.light, blur_px)
        if self.rays is None:
            return light
        rays = gathered(self.rays, blur_px)
        return np.asarray(light / rays.reshape(*rays.shape, *(1,) * (light.ndim - 2)))


def shade(light: np.ndarray, first: tuple[int, int], shading: Shading) -> None:
    """Take from the light in cells, in place, what a shading holds back.

    Parameters
    ----------
    light : ndarray of float32, shape (k, h, w, k) or (k, h, w, k, 3)
        As of :attr:`Film.light`.
    first : (int, int)
        The picture's column and row that are the first of these.
    shading : callable
    """
    left, top = first
    finer, rows, width, _, *channels = light.shape
    inside = (np.arange(finer) + 0.5) / finer - 0.5
    for i, j in np.ndindex(finer, finer):
        x, y = np.meshgrid(left + np.arange(width) + inside[j], top + np.arange(rows) + inside[i])
        share = shading(np.stack([x, y], axis=-1)).astype(np.float32)
        light[i, :, :, j] *= share.reshape(*share.shape, *(1,) * len(channels))


def is_even(draw: Draw, finer: int) -> bool:
    """Tell whether each cell has the same number of the rays of a draw."""
    return draw.count % finer**2 == 0 and draw.first % finer**2 == 0


def traced_cells(laboratory: Laboratory, camera: Rays, pixels: Places, draw: Draw, finer: int) -> Cells:
    """Trace some of the rays of pixels, apart by the cells in which they are.

    The rays of one cell choose points all over a lamp and an aperture: else cells would have noise where
    their pixels have none.

    Parameters
    ----------
    laboratory : Laboratory
    camera : Rays
    pixels : Places
    draw : Draw
        Which rays; they do not depend on the other pixels.
    finer : int
        Cells along a side of a pixel; a power of two.
    """
    import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

    mi, step = laboratory.mi, max(1, RAYS_AT_ONCE // draw.count)
    all_cells, even = finer**2, is_even(draw, finer)
    # Numbers that are opaque to the compiler leave one kernel for all pictures.
    each, across, every, seed = (dr.opaque(mi.UInt32, n) for n in (draw.count, finer, all_cells, draw.seed))
    of_a_cell = -(-draw.total // all_cells)
    own = dr.opaque(mi.UInt32, of_a_cell)
    shape = (-1, finer, finer, 3) if laboratory.colour else (-1, finer, finer)
    parts = []
    for first in range(0, len(pixels.number), step):
        some = slice(first, first + step)
        chosen = mi.UInt32(pixels.number[some].astype(np.uint32))
        lane = dr.arange(mi.UInt32, dr.width(chosen) * draw.count)
        local, index = lane // each, lane % each + dr.opaque(mi.UInt32, draw.first)
        pixel = dr.gather(mi.UInt32, chosen, local)
        column, row = (
            mi.Float64(dr.gather(mi.Int32, mi.Int32(part[some].astype(np.int32)), local))
            for part in (pixels.column, pixels.row)
        )
        within = Samples(mi, pixel, index, seed, draw.total).square(PIXEL)
        side = mi.Float(across)
        cell = mi.UInt32(within.y * side) * across + mi.UInt32(within.x * side)
        # Of as many successive samples as there are cells, one is in each.
        order = cell * own + index // every
        samples = Samples(mi, pixel, order, seed, all_cells * of_a_cell)
        light = laboratory.radiance(camera, (column, row), within, samples)
        ones = [] if even else [mi.Float(1.0)]
        parts.append(_sums(mi, [*light, *ones], local * every + cell, dr.width(chosen) * all_cells))
    channels = 3 if laboratory.colour else 1
    sums = np.concatenate([np.zeros((0, channels + (not even)), dtype=np.float32), *parts])
    sums *= np.float32(all_cells / draw.count)
    return Cells(
        np.ascontiguousarray(sums[:, :channels]).reshape(shape),
        None if even else np.ascontiguousarray(sums[:, channels]).reshape(-1, finer, finer),
    )


def _sums(mi: Jit, values: list[Jit], at: Jit, size: int) -> Float32[np.ndarray, "n channels"]:
    """Return the sums of values by their places; one thread adds them in a fixed order."""
    import drjit as dr  # noqa: PLC0415 -- only after ensure_llvm

    sums = [dr.zeros(mi.Float, size) for _ in values]
    for into, of in zip(sums, values, strict=True):
        dr.scatter_reduce(dr.ReduceOp.Add, into, of, at)
    dr.eval(*sums)
    return np.stack([np.array(one) for one in sums], axis=-1)
