"""Coded dots in one picture: found by their outline, named by their ring, measured by their edge."""

import numpy as np

from labcal.detect.grey import AnyPicture, GreyPicture, grey_picture
from labcal.detect.marks.picture_marks import MarkFlag, PictureMarks, SeenMark, collected
from labcal.detect.marks.ring_blur import ring_blur
from labcal.detect.marks.ring_light import Ring, without_rings
from labcal.detect.marks.ring_reading import NO_MARK, RingReading, has_white_gap, read_ring
from labcal.detect.marks.ring_samples import sample_ring
from labcal.detect.marks.round_dots import measured_spots, round_spots, sharp_spots
from labcal.detect.outlines.outlines import Outlines
from labcal.detect.settings import DEFAULTS, DetectSettings
from labcal.detect.stage_settings.mark import MarkSettings
from labcal.geometry.two_by_two import matrix_roots
from labcal.targets.coded_dots import RING_OUTER
from labcal.targets.ring_codes import CodeBook, RingCode, code_book

_LEAST_BLUR_PX = 0.3
"""Of any edge that is sampled between pixels."""
_HOPELESS = 0.25
"""Share of the evidence of a mark, below which perspective is not what it lacks."""
_CERTAIN = 2.0
"""Times the least margin, from which a name needs no better perspective."""
_FINEST = 0.2
"""Of the steps of the perspective."""


def find_coded_dots(
    image: AnyPicture, code: RingCode, settings: DetectSettings | None = None
) -> PictureMarks:
    """Find the coded dots of a code in one picture, black on white.

    Every round dot is looked at; those with a ring of the code around them are marks. Only these are
    measured, by the same fit as the dots of a grid, so that nothing else in the picture has a say in what is
    usual.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    code : RingCode
        Code of the rings. A picture may hold marks of several codes, each of which is looked for by itself.
    settings : DetectSettings, optional
        Thresholds, sizes and counts of all stages; the defaults where not given.

    Returns
    -------
    PictureMarks
        Points named ``CODE-NUMBER``, such as ``ring-23-17``. What looks like a mark and cannot be read has no
        name and a flag that says why.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`).
    """
    settings = DEFAULTS if settings is None else settings
    grey = grey_picture(image)
    size = (grey.shape[1], grey.shape[0])
    spots = round_spots(grey, settings, settings.mark.max_texture_share)
    book = code_book(RingCode(code))
    both = spots, sharp_spots(grey, spots, settings)
    read = [_read(grey, both, number, book, settings.mark) for number in range(len(spots.centre))]
    readings = [reading for reading, _ in read]
    seen = _each_once(readings, spots)
    named = [k for k in seen if readings[k].mark >= 0]
    marks = [
        SeenMark("", flag, spots.centre[k], spots.shape[k])
        for k in seen
        if (flag := readings[k].flag) is not None and readings[k].mark < 0
    ]
    if named:
        names = [f"{book.code}-{readings[k].mark}" for k in named]
        rings = [
            Ring(book.words[read[k][0].row], read[k][0].start, read[k][1], read[k][0].unlike) for k in named
        ]
        own = spots.select(np.array(named))
        marks += measured_spots(without_rings(grey, own, rings, settings), own, names, settings)
    return collected(marks, size)


def _read(
    grey: GreyPicture, both: tuple[Outlines, Outlines], number: int, book: CodeBook, settings: MarkSettings
) -> tuple[RingReading, np.ndarray]:
    """Read the ring around a spot: without perspective, then with that by which the best word fits best.

    Where the rough outline and its blur give no name, the sharp ones are tried, too. A second look finds a
    word in rings of other codes, with margins that are half as large: its name has to be certain.

    Returns the reading, and the displacement of the circle's centre at which it was read, in radii.
    """
    rough, sharp = (_View(grey, outlines, number, book, settings) for outlines in both)
    if not has_white_gap(
        sample_ring(grey, rough.centre, rough.root, np.zeros(2), book.code.sectors), settings
    ):
        return NO_MARK, np.zeros(2)
    first, at = rough.read(0.0), np.zeros(2)
    if first.evidence < settings.min_sight_log * _HOPELESS or _is_certain(first, settings):
        return first, at
    radius = float(both[0].radius[number])
    first, at = _with_perspective(rough, first, radius, settings)
    if first.flag is MarkFlag.OK:
        return first, at
    second, second_at = _with_perspective(sharp, sharp.read(0.0), radius, settings)
    return (second, second_at) if _is_certain(second, settings) else (first, at)


def _with_perspective(
    view: "_View", reading: RingReading, radius: float, settings: MarkSettings
) -> tuple[RingReading, np.ndarray]:
    """Return the reading with the perspective by which the best word fits best, and that of the centre."""
    best, at = reading, 0.0
    if _is_certain(best, settings):
        return best, np.zeros(2)
    farthest = min(settings.max_perspective_radii, settings.perspective_per_px * radius)
    width = settings.perspective_step_radii
    around = [sign * step for step in np.arange(width, farthest + 1e-9, width) for sign in (1.0, -1.0)]
    while around:
        top, step = max(((view.read(step), step) for step in around), key=lambda one: one[0].evidence)
        if top.evidence > best.evidence:
            best, at = top, step
        width *= 0.5
        around = [at - width, at + width] if width > settings.perspective_step_radii * _FINEST else []
    return best, at * view.minor


def _is_certain(reading: RingReading, settings: MarkSettings) -> bool:
    """Tell whether a ring has a name that no better perspective would change."""
    return reading.flag is MarkFlag.OK and reading.margin > settings.min_margin_log * _CERTAIN


class _View:
    """A ring as it is seen around one outline of its dot."""

    def __init__(
        self, grey: GreyPicture, outlines: Outlines, number: int, book: CodeBook, settings: MarkSettings
    ) -> None:
        self._grey, self._book, self._settings = grey, book, settings
        shape = outlines.shape[number]
        self.centre, self.root = outlines.centre[number], matrix_roots(shape[None])[0]
        self.minor = np.linalg.eigh(shape)[1][:, 0]
        self._blur = max(float(outlines.blur[number]), _LEAST_BLUR_PX)

    def read(self, step: float) -> RingReading:
        """Return the reading with a displacement of the circle's centre along the minor axis, in radii."""
        sectors = self._book.code.sectors
        samples = sample_ring(self._grey, self.centre, self.root, step * self.minor, sectors)
        return read_ring(samples, ring_blur(self.root, self._blur, sectors), self._book, self._settings)


def _each_once(readings: list[RingReading], spots: Outlines) -> list[int]:
    """Return the spots that are marks: the best of each place, and none that is part of another's ring."""
    marks = [k for k, one in enumerate(readings) if one.flag is not None]
    marks.sort(key=lambda k: (readings[k].mark < 0, -readings[k].evidence))
    kept: list[int] = []
    for k in marks:
        away = np.linalg.norm(spots.centre[kept] - spots.centre[k], axis=1)
        if not (away < np.maximum(spots.radius[kept], spots.radius[k])).any():
            kept.append(k)
    named = [k for k in kept if readings[k].mark >= 0]
    return [k for k in kept if not _is_in_a_ring(k, named if readings[k].mark >= 0 else kept, spots)]


def _is_in_a_ring(spot: int, marks: list[int], spots: Outlines) -> bool:
    """Tell whether a spot lies in the ring of a larger one: it is a sector."""
    away = spots.centre[spot] - spots.centre[marks]
    flat = np.linalg.solve(spots.shape[marks], away[..., None])[..., 0]
    radii = np.sqrt(np.einsum("ni,ni->n", away, flat))
    return bool(((radii > 0.0) & (radii < RING_OUTER) & (spots.radius[marks] > spots.radius[spot])).any())
