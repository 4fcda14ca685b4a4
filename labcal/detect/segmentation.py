"""Stage 1, segmentation: from a picture to outlines that may be dots, from coarse levels to fine ones."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from labcal.arrays import PixelCovariances
from labcal.detect.grey import GreyPicture, is_flat
from labcal.detect.matrices import eigenvalues
from labcal.detect.outlines.blobs import Blobs, Pyramid, blobs_of, joined
from labcal.detect.outlines.outlines import Outlines, inside_frame, trace_outlines
from labcal.detect.stage_settings.segmentation import SegmentationSettings
from labcal.targets.grid import DotGrid

_MARGIN = 0.5  # px beyond the outermost pixel centres: the frame


@dataclass(frozen=True)
class Candidates:
    """Outlines that may be dots, found in some levels of a picture.

    Attributes
    ----------
    blobs : Blobs
        The dark spots that the outlines were traced from.
    whole, cut : Outlines
        Outlines that lie in the frame, and those that reach beyond it.
    axes_px : tuple of float
        Bounds of the semi-axes (px) between which these levels miss no dot.
    """

    blobs: Blobs
    whole: Outlines
    cut: Outlines
    axes_px: tuple[float, float]

    def resolve(self, shape: PixelCovariances) -> bool:
        """Tell whether no dot is missed among others with these outline matrices, shape (n, 2, 2)."""
        minor, major = np.sqrt(eigenvalues(shape)).T
        return bool(minor.min() >= self.axes_px[0] and major.max() <= self.axes_px[1])


def segmentations(grey: GreyPicture, target: DotGrid, settings: SegmentationSettings) -> Iterator[Candidates]:
    """Yield the candidates of one coarse level, of all coarser ones too, and of ever finer ones with them.

    Whoever takes them stops where nothing is missed; the last ones hold everything there is.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture, dots darker than the board.
    target : DotGrid
    settings : SegmentationSettings
    """
    levels = Pyramid(grey, settings)
    if is_flat(grey) or not levels.scales:  # however large: there is nothing to look at
        nothing = joined([])
        outlines = trace_outlines(grey, nothing, target, settings)
        yield _candidates(grey, nothing, outlines, (np.inf, 0.0))
        return
    count, longest = len(levels.scales), max(grey.shape)
    start = next((k for k in range(count) if longest >> k <= settings.coarse_side_px), 0)
    looks = [range(start, start + 1), *(range(finest, count) for finest in range(start, -1, -1))]
    blobs: dict[int, Blobs] = {}
    first = True
    for look in looks:
        for number in look:
            if number not in blobs:
                blobs[number] = blobs_of(levels.level(number), settings)
        largest = levels.scales[start] * settings.max_spot_axis_px if first else np.inf
        first = False
        smallest = settings.min_resolved_axis_px * levels.scales[look.start]
        found = joined([blobs[number] for number in sorted(blobs)])
        outlines = trace_outlines(grey, found, target, settings)
        yield _candidates(grey, found, outlines, (smallest, largest))


def _candidates(
    grey: GreyPicture, blobs: Blobs, outlines: Outlines, axes_px: tuple[float, float]
) -> Candidates:
    """Return the outlines of blobs, sorted by whether the frame cuts them."""
    inside = inside_frame(outlines.centre, outlines.shape, (grey.shape[1], grey.shape[0]), _MARGIN)
    return Candidates(blobs, outlines.select(inside), outlines.select(~inside), axes_px)
