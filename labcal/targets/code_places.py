"""Form of the block of a print's code: a QR code between two AprilTags, on one middle line.

Lengths are in units of the block, which larger sheets have longer: tag, gap, QR code, gap, tag. The eight
corners of the tags so fix a homography under which the cells of the QR code are read where they must be, in
pictures in which no search for a QR code would find it.
"""

import numpy as np

from labcal.arrays import Pixels
from labcal.targets.charuco import MarkerDictionary

TAG, QR, GAP = 16.0, 27.0, 4.0
"""Sides of a tag and of the QR code, and what is between them: mm on most sheets."""
BLOCK_WIDTH, BLOCK_HEIGHT = 2 * (TAG + GAP) + QR, QR
QR_LEFT = TAG + GAP
TAG_TOP = 0.5 * (BLOCK_HEIGHT - TAG)
RIGHT_TAG_LEFT = TAG + QR + 2 * GAP
DICTIONARY = MarkerDictionary.DICT_APRILTAG_36H11
FIRST_TAG = 87
"""Tags below are left to laboratories, which number their own from 0."""
NUMBERS = (DICTIONARY.size - FIRST_TAG) // 2
"""Number of prints that tags distinguish, each with a left and a right one."""


def tags_of(number: int) -> tuple[int, int]:
    """Return the left and the right tag of prints with a number."""
    return FIRST_TAG + 2 * number, FIRST_TAG + 2 * number + 1


def print_of(tag: int) -> tuple[int, int] | None:
    """Return the number of the print that a tag belongs to, and 0 for its left one, 1 for its right one."""
    if not FIRST_TAG <= tag < FIRST_TAG + 2 * NUMBERS:
        return None
    number, side = divmod(tag - FIRST_TAG, 2)
    return number, side


def tag_corners() -> Pixels:
    """Return the corners of the left tag and of the right one, y down from the block's top, shape (8, 2).

    Each tag's four as OpenCV orders them: clockwise from the upper left one.
    """
    left = np.array([[0.0, TAG_TOP], [TAG, TAG_TOP], [TAG, TAG_TOP + TAG], [0.0, TAG_TOP + TAG]])
    return np.concatenate([left, left + np.array([RIGHT_TAG_LEFT, 0.0])])
