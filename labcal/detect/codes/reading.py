"""Descriptions of targets, read from the codes of their prints."""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.detect.codes.qr_cells import read_cells
from labcal.detect.codes.tag_pairs import BytePicture, CodeBlock, find_blocks
from labcal.detect.grey import AnyPicture, grey_picture
from labcal.errors import InputError
from labcal.targets.code_places import NUMBERS, tags_of
from labcal.targets.code_text import PrintedTarget, described_by, text_number
from labcal.wording import clipped

_RANGE_PERCENT = (0.5, 99.5)  # of grey values: black and white of the picture that is searched
_RANGE_PIXELS = 100_000  # in a regular sample; 500 of them beyond each end
_LEAST_SIDE_PX = 32
_SHOWN_LETTERS = 40


@dataclass(frozen=True)
class PictureCodes:
    """The codes in one picture.

    Attributes
    ----------
    prints : tuple of PrintedTarget
        Prints whose description is read, each once.
    blocks : tuple of CodeBlock
        Prints whose tags are seen, whether they are read or not.
    refused : tuple of str
        Reasons why codes that claim to be labcal's are not believed, each a sentence.
    foreign : tuple of str
        Beginnings of the texts of other QR codes.
    """

    prints: tuple[PrintedTarget, ...] = ()
    blocks: tuple[CodeBlock, ...] = ()
    refused: tuple[str, ...] = ()
    foreign: tuple[str, ...] = ()


def read_codes(image: AnyPicture) -> PictureCodes:
    """Read the codes of prints in one picture, by their tags, or else wherever OpenCV finds a QR code.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.

    Returns
    -------
    PictureCodes
        What no code says, or a code that lies, is none of its prints.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`).
    """
    picture = searched_picture(image)
    if picture is None:
        return PictureCodes()
    blocks = find_blocks(picture)
    texts: dict[str, int | None] = {}
    for block in blocks:
        text = read_cells(picture, block)
        if text is not None:
            texts.setdefault(text, block.number)
    if not texts:
        texts = dict.fromkeys(_searched(picture))
    prints: dict[str, PrintedTarget] = {}
    refused, foreign = [], []
    for text, number in texts.items():
        try:
            found = described_by(text)
        except InputError as error:
            refused.append(str(error))
            continue
        if found is None:
            foreign.append(clipped(text, _SHOWN_LETTERS))
        elif number is not None and number != text_number(text, NUMBERS):
            own, seen = tags_of(text_number(text, NUMBERS)), tags_of(number)
            refused.append(
                f"It says that it is '{found.name}', whose tags are {own[0]} and {own[1]}, but is between "
                f"the tags {seen[0]} and {seen[1]}."
            )
        else:
            prints[text] = found
    return PictureCodes(tuple(prints.values()), tuple(blocks), tuple(refused), tuple(foreign))


def searched_picture(image: AnyPicture) -> BytePicture | None:
    """Return the picture in grey values from 0 to 255; None where it has no contrast, or hardly a pixel."""
    grey = grey_picture(image)
    if min(grey.shape) < _LEAST_SIDE_PX:
        return None
    step = max(1, int(np.sqrt(grey.size / _RANGE_PIXELS)))
    low, high = np.percentile(grey[::step, ::step], _RANGE_PERCENT)
    if not high > low:
        return None
    scale = np.float32(255.0 / (high - low))  # of 32 bits, as the picture: twice as fast
    return np.asarray(np.clip((grey - np.float32(low)) * scale, 0, 255), dtype=np.uint8)


def _searched(picture: BytePicture) -> list[str]:
    """Return the texts of QR codes that OpenCV finds."""
    try:
        _, texts, _, _ = cv2.QRCodeDetectorAruco().detectAndDecodeMulti(picture)
    except (cv2.error, UnicodeDecodeError):  # of what looks like a code and is none
        return []
    return [text for text in texts if text]
