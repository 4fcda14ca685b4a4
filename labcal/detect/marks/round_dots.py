"""Round dark dots that are no grid: their rough outlines, and the fit of their edges."""

import numpy as np

from labcal.arrays import PixelCovariances
from labcal.detect.checks.usual_light import misfits
from labcal.detect.edge_fit import EdgeFits, fit_edges
from labcal.detect.grey import GreyPicture, is_flat
from labcal.detect.light_fall import lit_centres
from labcal.detect.marks.picture_marks import MarkFlag, SeenMark
from labcal.detect.outlines.blobs import Pyramid, blobs_of, joined
from labcal.detect.outlines.outlines import Outlines, clear_reach, inside_frame, trace_outlines
from labcal.detect.settings import DetectSettings
from labcal.geometry.two_by_two import eigenvalues
from labcal.targets.coded_dots import RING_INNER
from labcal.targets.grid import DotGrid

_SURROUNDED = DotGrid(
    name="coded-dot",
    cols=2,
    rows=2,
    pitch_x_mm=0.5 * (1.0 + RING_INNER),
    pitch_y_mm=0.5 * (1.0 + RING_INNER),
    dot_diameter_mm=1.0,
    rings=None,
)
"""A grid whose dots have as much paper around them as a coded dot has within its ring."""
_NEAR = 0.12
"""Most that a fit departs from a rough outline of the same dot, in radii."""
_MARGIN = 0.5  # px beyond the outermost pixel centres: the frame
_SECTORS_OVER_CENTRE = 6.0**0.5
"""Standard deviation of the place of a twelfth of an outline, over that of the centre along an axis."""


def round_spots(grey: GreyPicture, settings: DetectSettings, max_texture_share: float) -> Outlines:
    """Return all round dark dots of a picture, of every size, that lie whole in the frame.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    settings : DetectSettings
    max_texture_share : float
        Most changes between dark and bright a pixel along a row, around a dot.
    """
    search = settings.segmentation.model_copy(update={"max_texture_share": max_texture_share})
    levels = Pyramid(grey, search)
    count = 0 if is_flat(grey) else len(levels.scales)
    blobs = joined([blobs_of(levels.level(number), search) for number in range(count)])
    outlines = trace_outlines(grey, blobs, _SURROUNDED, search)
    inside = inside_frame(outlines.centre, outlines.shape, (grey.shape[1], grey.shape[0]), _MARGIN)
    return outlines.select(inside)


def surrounded_reach(settings: DetectSettings) -> float:
    """Return how far from a dot's centre there is paper alone, in radii."""
    return clear_reach(_SURROUNDED, settings.segmentation)


def sharp_spots(grey: GreyPicture, spots: Outlines, settings: DetectSettings) -> Outlines:
    """Return spots with centre, outline and blur of the fit of their edge, where that is near the rough one.

    The rough blur is too small where little paper is around a dot: of a dot whose blur is a third of its
    radius, with a ring, 1.3 px instead of 2.1 px. And the rough outline is a blurred one.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    spots : Outlines
    settings : DetectSettings
    """
    if not len(spots.centre):
        return spots
    fits = fit_edges(grey, spots, np.zeros(len(spots.centre)), surrounded_reach(settings), 0.0, settings.edge)
    centre, shape = lit_centres(fits), sharp_shapes(fits)
    with np.errstate(invalid="ignore"):
        grown = (np.linalg.det(shape) / np.linalg.det(spots.shape)) ** 0.25
        near = fits.ok & (np.abs(np.log(grown)) < _NEAR)
        near &= np.linalg.norm(centre - spots.centre, axis=1) < _NEAR * spots.radius
    return Outlines(
        np.where(near[:, None], centre, spots.centre),
        np.where(near[:, None, None], shape, spots.shape),
        spots.hole,
        np.where(near, fits.blur, spots.blur),
    )


def measured_spots(
    grey: GreyPicture, spots: Outlines, names: list[str], settings: DetectSettings
) -> list[SeenMark]:
    """Return named dots with the fit of their edge, flagged as the dots of a grid are.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    spots : Outlines
    names : list of str
        A name for each spot.
    settings : DetectSettings
    """
    reach = surrounded_reach(settings)
    fits = fit_edges(grey, spots, np.zeros(len(names)), reach, 0.0, settings.edge)
    flags = _flags(fits, spots, settings)
    centres, shapes = lit_centres(fits), sharp_shapes(fits)
    marks = []
    for number, (name, flag) in enumerate(zip(names, flags, strict=True)):
        if flag is MarkFlag.OK:
            place, S = centres[number], shapes[number]
            marks.append(SeenMark(name, flag, place, S, place, fits.covariance[number]))
        else:
            marks.append(SeenMark(name, flag, spots.centre[number], spots.shape[number]))
    return marks


def sharp_shapes(fits: EdgeFits) -> PixelCovariances:
    """Return the matrices of outlines without what blur shrinks them by.

    Parameters
    ----------
    fits : EdgeFits

    Notes
    -----
    A blurred disc of radius r is half dark at a radius that is smaller by half the variance of the blur over
    r; of an ellipse the radius of curvature takes the place of r.
    """
    with np.errstate(invalid="ignore"):
        values, axes = np.linalg.eigh(np.where(fits.ok[:, None, None], fits.shape, np.eye(2)))
        semi = np.sqrt(values)
        curvature = semi / semi[:, ::-1] ** 2
        semi = semi + 0.5 * (fits.blur**2)[:, None] * curvature
    found = (axes * (semi**2)[:, None, :]) @ axes.swapaxes(1, 2)
    return np.asarray(np.where(fits.ok[:, None, None], found, np.nan))


def _flags(fits: EdgeFits, spots: Outlines, settings: DetectSettings) -> list[MarkFlag]:
    """Return the flag of every named dot, by its fit and by what is usual among the picture's marks.

    A picture may hold one mark alone. So the departure of an outline from its ellipse is compared with what
    noise explains, too.
    """
    limits = settings.quality
    dark, light = np.minimum(fits.board, fits.dot), np.maximum(fits.board, fits.dot)
    misfit = misfits(dark, light, fits.variance, limits)
    usual = float(np.median(fits.departure[fits.ok])) if fits.ok.any() else 0.0
    noise = _SECTORS_OVER_CENTRE * np.sqrt(np.trace(fits.covariance, axis1=1, axis2=2) / 2.0)
    usual = np.minimum(usual, settings.mark.usual_departure_factor * noise)
    farthest = limits.departure_factor * np.maximum(usual, noise) + limits.departure_share * spots.radius
    rough = (fits.departure > farthest) | (misfit > limits.max_misfit_factor)
    minor = np.sqrt(eigenvalues(spots.shape)[:, 0])
    flags = []
    for number in range(len(spots.centre)):
        if spots.blur[number] > limits.max_blur_share * minor[number]:
            flags.append(MarkFlag.BLURRED)
        elif fits.ok[number] and fits.clipped[number] > limits.max_clipped_share:
            flags.append(MarkFlag.SATURATED)
        elif not fits.ok[number] or rough[number]:
            flags.append(MarkFlag.BAD_FIT)
        else:
            flags.append(MarkFlag.OK)
    return flags
