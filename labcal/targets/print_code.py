"""The code of a print: a QR code with the description of its target, between two AprilTags."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Bool
from matplotlib.path import Path as Outline

from labcal.targets.cell_outlines import cell_outlines, moved
from labcal.targets.charuco_opencv import opencv_dictionary
from labcal.targets.code_places import DICTIONARY, NUMBERS, QR, QR_LEFT, RIGHT_TAG_LEFT, TAG, TAG_TOP, tags_of
from labcal.targets.code_text import text_number

_TAG_CELLS = 8  # with the border


@dataclass(frozen=True)
class PrintCode:
    """The cells of a print's code.

    Attributes
    ----------
    text : str
        What the QR code says.
    qr : ndarray of bool, shape (n, n)
        Its black cells, top row first, without the quiet zone.
    tags : tuple of ndarray of bool, each of shape (8, 8)
        Black cells of the left tag and of the right one, borders included.
    """

    text: str
    qr: Bool[np.ndarray, "n n"]
    tags: tuple[Bool[np.ndarray, "8 8"], Bool[np.ndarray, "8 8"]]

    def outlines(self, left: float, top: float, unit: float) -> Outline:
        """Return the outlines of all black cells.

        Parameters
        ----------
        left, top : float
            The upper left corner of the block in the target's frame, mm.
        unit : float
            Length of a unit of the block, mm.
        """
        parts = (
            (self.tags[0], 0.0, TAG_TOP, TAG),
            (self.qr, QR_LEFT, 0.0, QR),
            (self.tags[1], RIGHT_TAG_LEFT, TAG_TOP, TAG),
        )
        return Outline.make_compound_path(
            *(
                moved(
                    cell_outlines(cells),
                    unit * side / len(cells),
                    np.array([left + unit * x, top - unit * (y + side)]),
                )
                for cells, x, y, side in parts
            )
        )


def print_code(text: str) -> PrintCode:
    """Return the code that says a text of :func:`labcal.targets.code_text.code_text`."""
    parameters = cv2.QRCodeEncoder.Params()
    parameters.mode = cv2.QRCodeEncoder_MODE_ALPHANUMERIC
    parameters.correction_level = cv2.QRCodeEncoder_CORRECT_LEVEL_M
    drawn = np.asarray(cv2.QRCodeEncoder.create(parameters).encode(text)) == 0
    rows, cols = np.flatnonzero(drawn.any(axis=1)), np.flatnonzero(drawn.any(axis=0))
    qr = drawn[rows[0] : rows[-1] + 1, cols[0] : cols[-1] + 1]
    dictionary = opencv_dictionary(DICTIONARY)
    left, right = (
        np.asarray(dictionary.generateImageMarker(tag, _TAG_CELLS, borderBits=1)) == 0
        for tag in tags_of(text_number(text, NUMBERS))
    )
    return PrintCode(text, qr, (left, right))
