"""The tags beside the codes of prints: which prints a picture shows, and where."""

from dataclasses import dataclass

import cv2
import numpy as np
from jaxtyping import Float64, UInt8

from labcal.arrays import Pixels
from labcal.targets.charuco_opencv import opencv_dictionary
from labcal.targets.code_places import DICTIONARY, TAG, print_of, tag_corners

BytePicture = UInt8[np.ndarray, "h w"]

_LEAST_TAG_PX = 8.0  # one pixel a cell
_SEARCHED_PX = (
    1300,
    2600,
)  # longer side of the search, not of the corners; the finer one where nothing is found
_WORST_RESIDUAL = 0.06  # RMS over the side of a tag: 8 corners of one plane leave 0.01 in a sharp picture


@dataclass(frozen=True)
class CodeBlock:
    """The block of a print's code in a picture.

    Attributes
    ----------
    number : int
        That of the print, which its tags tell.
    homography : ndarray, shape (3, 3)
        From units of the block (x right, y down, from its upper left corner) to px.
    is_whole : bool
        True if both tags are seen; with one, the homography is good beside it only.
    """

    number: int
    homography: Float64[np.ndarray, "3 3"]
    is_whole: bool

    def places(self, units: Pixels) -> Pixels:
        """Return places in units of the block in px, NaN behind the camera; shape (n, 2)."""
        at = np.column_stack([units, np.ones(len(units))]) @ self.homography.T
        inside = at[:, 2:] * float((self.homography @ [TAG, TAG, 1.0])[2]) > 0
        with np.errstate(divide="ignore", invalid="ignore"):
            return np.where(inside, at[:, :2] / at[:, 2:], np.nan)


def find_blocks(picture: BytePicture) -> list[CodeBlock]:
    """Return the blocks of codes in a picture, by their number, then from left to right.

    Parameters
    ----------
    picture : ndarray of uint8, shape (h, w)
    """
    side = max(picture.shape)
    rough = [most for most in _SEARCHED_PX[:-1] if most < side]
    for most in (*rough, _SEARCHED_PX[-1]):
        blocks = _paired(*_tags(picture, most))
        if any(block.is_whole for block in blocks):
            break
    return blocks


def _paired(left: dict[int, list[Pixels]], right: dict[int, list[Pixels]]) -> list[CodeBlock]:
    """Return the blocks of left and right tags that belong together, and of those that are alone."""
    units = tag_corners()
    blocks, used = list[CodeBlock](), set[int]()
    for number in sorted({*left, *right}):
        pairs = [
            (a, b, _fitted(units, np.concatenate([a, b])))
            for a in left.get(number, [])
            for b in right.get(number, [])
        ]
        for a, b, (homography, residual) in sorted(pairs, key=lambda pair: pair[2][1]):
            if residual < _WORST_RESIDUAL and not {id(a), id(b)} & used:
                used |= {id(a), id(b)}
                blocks.append(CodeBlock(number, homography, is_whole=True))
        for side, tags in enumerate((left, right)):
            for tag in tags.get(number, []):
                if id(tag) not in used:
                    homography, _ = _fitted(units[4 * side : 4 * side + 4], tag)
                    blocks.append(CodeBlock(number, homography, is_whole=False))
    return sorted(blocks, key=lambda block: (block.number, float(block.places(np.zeros((1, 2)))[0, 0])))


def _fitted(units: Pixels, seen: Pixels) -> tuple[Float64[np.ndarray, "3 3"], float]:
    """Return the homography to tags' corners, and the RMS residual over the side of a tag."""
    found, _ = cv2.findHomography(units, seen, 0)
    if found is None or not np.isfinite(found).all():
        return np.eye(3), np.inf
    homography = np.asarray(found, dtype=np.float64)
    at = np.column_stack([units, np.ones(len(units))]) @ homography.T
    if not (at[:, 2] > 0).all():
        return homography, np.inf
    off = np.sqrt(((at[:, :2] / at[:, 2:] - seen) ** 2).sum(axis=1).mean())
    side = np.sqrt(min(cv2.contourArea(tag.astype(np.float32)) for tag in seen.reshape(-1, 4, 2)))
    return homography, float(off / side) if side > 0 else np.inf


def _tags(picture: BytePicture, most: int) -> tuple[dict[int, list[Pixels]], dict[int, list[Pixels]]]:
    """Return the left tags and the right tags by the number of their print, corners in px, (4, 2).

    The longer side of what is searched has at most so many pixels.
    """
    parameters = cv2.aruco.DetectorParameters()
    factor = max(1.0, max(picture.shape) / most)
    searched = picture
    if factor > 1.0:
        size = (round(picture.shape[1] / factor), round(picture.shape[0] / factor))
        searched = cv2.resize(picture, size, interpolation=cv2.INTER_AREA)
    parameters.minMarkerPerimeterRate = min(0.03, 4.0 * _LEAST_TAG_PX / max(searched.shape))
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    detector = cv2.aruco.ArucoDetector(opencv_dictionary(DICTIONARY), parameters)
    corners, ids, _ = detector.detectMarkers(searched)
    sides: tuple[dict[int, list[Pixels]], dict[int, list[Pixels]]] = ({}, {})
    numbers: list[int] = [] if ids is None else np.asarray(ids, dtype=np.int64).ravel().tolist()
    for tag, quad in zip(numbers, corners, strict=True):
        known = print_of(tag)
        if known is None:
            continue
        number, side = known
        sides[side].setdefault(number, []).append(_refined(picture, np.asarray(quad), factor))
    return sides


def _refined(picture: BytePicture, quad: np.ndarray, factor: float) -> Pixels:
    """Return the corners of a tag in the picture that was reduced by a factor for the search."""
    corners = np.asarray(quad, dtype=np.float32).reshape(4, 1, 2)
    if factor > 1.0:
        corners = np.ascontiguousarray((corners + np.float32(0.5)) * np.float32(factor) - np.float32(0.5))
        stop = (cv2.TERM_CRITERIA_EPS + cv2.TERM_CRITERIA_MAX_ITER, 30, 0.02)
        reach = max(2, round(2 * factor))
        corners = np.asarray(cv2.cornerSubPix(picture, corners, (reach, reach), (-1, -1), stop))
    return corners.reshape(4, 2).astype(np.float64)
