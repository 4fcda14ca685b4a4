"""Ellipses through the edge points of spots, and how bright the spots' middles are."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.grey import GreyPicture
from labcal.detect.matrices import inside, matrix_roots, mean_radii
from labcal.detect.outlines.blobs import Blobs
from labcal.detect.outlines.rays import COLUMNS, RayLimits, distinct, ray_directions, trace_all
from labcal.detect.stage_settings.segmentation import SegmentationSettings
from labcal.targets.grid import DotGrid


@dataclass(frozen=True)
class Outlines:
    """Spots with a clean elliptic edge.

    Attributes
    ----------
    centre : ndarray, shape (n, 2)
        px, good to a tenth or so.
    shape : ndarray, shape (n, 2, 2)
        Outline matrices, see `PictureDots.outline`.
    hole : ndarray, shape (n,)
        Brightness of the middle: 0 as dark as the dot, 1 as bright as the board.
    blur : ndarray, shape (n,)
        Standard deviation of the edge, px, roughly.
    """

    centre: Pixels
    shape: PixelCovariances
    hole: Float64[np.ndarray, " n"]
    blur: Float64[np.ndarray, " n"]

    @property
    def radius(self) -> Float64[np.ndarray, " n"]:
        """Geometric mean of the semi-axes, px."""
        return mean_radius(self.shape)

    def select(self, which: np.ndarray) -> "Outlines":
        """Return some of the spots, by mask or by index."""
        return Outlines(self.centre[which], self.shape[which], self.hole[which], self.blur[which])

    def joined(self, other: "Outlines") -> "Outlines":
        """Return these spots and then others."""
        return Outlines(
            np.concatenate([self.centre, other.centre]),
            np.concatenate([self.shape, other.shape]),
            np.concatenate([self.hole, other.hole]),
            np.concatenate([self.blur, other.blur]),
        )


def mean_radius(shape: PixelCovariances) -> Float64[np.ndarray, " n"]:
    """Return the geometric means of outlines' semi-axes, px."""
    return mean_radii(shape)


def clear_reach(target: DotGrid, settings: SegmentationSettings) -> float:
    """Return how far from a dot's centre, in radii, nothing but board surrounds it."""
    radius = target.largest_diameter_mm / 2
    gap = min(target.cell_mm) / radius - 2
    return 1 + settings.clear_gap_share * gap


def trace_outlines(
    grey: GreyPicture, blobs: Blobs, target: DotGrid, settings: SegmentationSettings
) -> Outlines:
    """Return the spots that have an elliptic edge in the full picture, each once."""
    whole = ~blobs.cut
    centre, shape = blobs.centre[whole], blobs.shape[whole]
    # Spots that are found in several levels are taken from the finest first; most duplicates go here,
    # cheaply.
    first = distinct(centre, mean_radius(shape), settings.duplicate_spot_radii)
    spots, _ = trace_from(grey, centre[first], shape[first], target, settings)
    return spots.select(distinct(spots.centre, spots.radius, settings.duplicate_outline_radii))


def trace_from(
    grey: GreyPicture,
    centre: Pixels,
    shape: PixelCovariances,
    target: DotGrid,
    settings: SegmentationSettings,
) -> tuple[Outlines, np.ndarray]:
    """Return what has an elliptic edge near rough centres and outlines, and which of these it is.

    Rays are cast a second time, from the ellipse that the first time gave, where that lies off.
    """
    reach = min(settings.ray_length_radii, clear_reach(target, settings))
    limits, rays = settings.limits(RayLimits), ray_directions(settings.ray_count)
    which = np.arange(len(centre) if min(grey.shape) > 1 else 0)
    spots = _for_rays(centre[which], shape[which])
    table = np.zeros((len(which), COLUMNS))
    ok = trace_all(grey, spots, rays, (reach, target.hole_share), limits, table)
    traced, radius = _for_rays(table[ok, :2], _shape_of(table[ok])), mean_radius(_shape_of(table[ok]))
    off = np.flatnonzero(ok)[np.abs(traced - spots[ok]).max(axis=1) > settings.retrace_radii * radius]
    again = table[off]
    spots = _for_rays(again[:, :2], _shape_of(again))
    ok[off] = trace_all(grey, spots, rays, (reach, target.hole_share), limits, again)
    table[off] = again
    table, which = table[ok], which[ok]
    return Outlines(table[:, :2], _shape_of(table), table[:, 5], table[:, 6]), which


def _for_rays(centre: Pixels, shape: PixelCovariances) -> np.ndarray:
    """Return centres and outlines as rays begin from them: x, y, and xx xy yy of the outlines' roots."""
    root = matrix_roots(shape)
    spots: np.ndarray = np.concatenate([centre, root[:, 0], root[:, 1, 1:]], axis=1)
    return spots


def _shape_of(table: np.ndarray) -> PixelCovariances:
    """Return the outline matrices of traced spots."""
    shape: np.ndarray = table[:, [2, 3, 3, 4]].reshape(-1, 2, 2)
    return shape


def inside_frame(centre: Pixels, shape: PixelCovariances, size: tuple[int, int], margin: float) -> Mask:
    """Tell which outlines lie whole in a picture of some width and height, up to a margin beyond (px)."""
    return inside(centre, shape, size, margin)
