"""Cells of a QR code, read where two tags say that they are.

A search for the three corner marks of a QR code fails where a cell has fewer than three or four pixels. Here
the tags tell where each cell is; its grey value is compared with its surroundings, what every QR code has in
common is put in its place, and OpenCV decodes the picture that is drawn of the cells.
"""

import cv2
import numpy as np
from jaxtyping import Bool, Float64

from labcal.detect.codes.tag_pairs import BytePicture, CodeBlock
from labcal.targets.code_places import QR, QR_LEFT

_SIZES = (21, 25, 29, 33, 37, 41)  # cells along a side, versions 1 to 6
_OFFSETS = (0.0, -0.3, 0.3, -0.6, 0.6)  # cells, for corners of tags that are a fraction of a pixel off
_SHARPENING = (0.0, 0.5, 1.0, 2.0, 4.0)  # times what blur took; the first one that decodes is taken
_LEAST_CORRELATION = 0.4  # of the common cells; 200 cells of noise reach 0.25 once in 3000
_PARTS = 3  # samples across a cell, in its inner part
_INNER = (0.3, 0.4)  # where it begins, and its width
_WINDOW = 7  # cells, as wide as a corner mark: both colours are in every such window
_DRAWN_PX = 6  # a cell, for the decoder
_QUIET = 4  # cells


def read_cells(picture: BytePicture, block: CodeBlock) -> str | None:
    """Return the text of the QR code of a block; None where it cannot be read.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    block : CodeBlock
        The tags' place; the smaller the code, the better it should be known.
    """
    grey = picture.astype(np.float32)
    cells = max(
        (_sampled(grey, block, size, (0.0, 0.0)) for size in _SIZES),
        key=_likeness,
    )
    offsets = [(x, y) for x in _OFFSETS for y in _OFFSETS]
    cells = max((_sampled(grey, block, len(cells), offset) for offset in offsets), key=_likeness)
    if not _likeness(cells) > _LEAST_CORRELATION:
        return None
    for share in _SHARPENING:
        text = _decoded(_white(cells, share))
        if text:
            return text
    return None


def _sampled(
    grey: np.ndarray, block: CodeBlock, size: int, offset: tuple[float, float]
) -> Float64[np.ndarray, "n n"]:
    """Return the mean grey values of cells, top row first, NaN behind the camera."""
    first, width = _INNER
    within = first + width * (np.arange(_PARTS) + 0.5) / _PARTS
    at = ((np.arange(size)[:, None] + within) * (QR / size)).ravel()
    step = QR / size
    x, y = np.meshgrid(QR_LEFT + at + offset[0] * step, at + offset[1] * step)
    places = block.places(np.stack([x.ravel(), y.ravel()], axis=1)).astype(np.float32)
    places = np.nan_to_num(places, nan=-1.0).reshape(len(at), len(at), 2)
    seen = cv2.remap(grey, places[..., 0], places[..., 1], cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    parts = np.asarray(seen, dtype=np.float64).reshape(size, _PARTS, size, _PARTS)
    return np.asarray(parts.mean(axis=(1, 3)))


def _common(size: int) -> Float64[np.ndarray, "n n"]:
    """Return the cells that all QR codes of a size have: 1 white, 0 black, NaN for all others."""
    mark = np.zeros((7, 7))
    mark[1:6, 1:6] = 1.0
    mark[2:5, 2:5] = 0.0
    corner = np.ones((8, 8))
    corner[:7, :7] = mark
    cells = np.full((size, size), np.nan)
    cells[:8, :8], cells[:8, -8:], cells[-8:, :8] = corner, corner[:, ::-1], corner[::-1]
    timing = np.arange(8, size - 8) % 2
    cells[6, 8:-8] = cells[8:-8, 6] = timing
    return cells


def _likeness(cells: Float64[np.ndarray, "n n"]) -> float:
    """Return the correlation of grey values with the cells that all QR codes have; -1 without contrast."""
    common = _common(len(cells))
    known = ~np.isnan(common)
    seen, wanted = cells[known], common[known]
    if seen.std() == 0:
        return -1.0
    return float(np.corrcoef(seen, wanted)[0, 1])


def _white(cells: Float64[np.ndarray, "n n"], share: float) -> Bool[np.ndarray, "n n"]:
    """Return which cells are white: those lighter than the middle between black and white around them."""
    seen = cells.astype(np.float32)
    sharp = seen + np.float32(share) * (seen - cv2.GaussianBlur(seen, (0, 0), 1.0))
    window = np.ones((_WINDOW, _WINDOW), dtype=np.uint8)
    low, high = cv2.erode(sharp, window), cv2.dilate(sharp, window)
    middle = 0.5 * (cv2.GaussianBlur(low, (0, 0), 3.0) + cv2.GaussianBlur(high, (0, 0), 3.0))
    common = _common(len(cells))
    return np.asarray(np.where(np.isnan(common), sharp > middle, common > 0.5))  # noqa: PLR2004 -- 0 or 1


def _decoded(white: Bool[np.ndarray, "n n"]) -> str | None:
    """Return the text of the cells; None where they are no QR code."""
    drawn = np.pad(np.where(white, 255, 0).astype(np.uint8), _QUIET, constant_values=255)
    drawn = np.kron(drawn, np.ones((_DRAWN_PX, _DRAWN_PX), dtype=np.uint8))
    try:
        text, _, _ = cv2.QRCodeDetector().detectAndDecode(drawn)
    except (cv2.error, UnicodeDecodeError):  # of cells that are no code
        return None
    return text or None
