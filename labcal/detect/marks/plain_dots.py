"""Plain dots in one picture: round, dark, with bright paper around them, and without names."""

import numpy as np

from labcal.detect.grey import AnyPicture, grey_picture
from labcal.detect.marks.picture_marks import PictureMarks, collected
from labcal.detect.marks.round_dots import measured_spots, round_spots
from labcal.detect.settings import DEFAULTS, DetectSettings

PREFIX = "dot"
"""Of the names of plain dots."""


def find_plain_dots(image: AnyPicture, settings: DetectSettings | None = None) -> PictureMarks:
    """Find plain round dots in one picture, black on white; they need not be alike, nor in a grid.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    settings : DetectSettings, optional
        Thresholds, sizes and counts of all stages; the defaults where not given.

    Returns
    -------
    PictureMarks
        Points named ``dot-NUMBER``, counted from 0 in this picture, by y, then x. A name of one picture says
        nothing of another: dots are matched by geometry
        (:func:`labcal.reconstruct.plain_dots.matched_dots`).

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`).
    """
    settings = DEFAULTS if settings is None else settings
    grey = grey_picture(image)
    spots = round_spots(grey, settings, settings.segmentation.max_texture_share)
    spots = spots.select(np.lexsort((spots.centre[:, 0], spots.centre[:, 1])))
    names = [f"{PREFIX}-{number}" for number in range(len(spots.centre))]
    marks = measured_spots(grey, spots, names, settings) if names else []
    return collected(marks, (grey.shape[1], grey.shape[0]))
