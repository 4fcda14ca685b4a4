"""Drawn pictures of marks on a bent surface as two cameras see them, with the true places of all marks."""

from collections.abc import Callable
from dataclasses import dataclass

import cv2
import numpy as np

from labcal import examples
from labcal.bench.marks.drawn_picture import INK, PAPER, finer
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.detect.marks.tags import tag_name
from labcal.rng import generator
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.charuco_opencv import opencv_dictionary
from labcal.targets.coded_dots import QUIET, RING_INNER, RING_OUTER
from labcal.targets.ring_codes import RingCode, code_book

CODE = RingCode.RING_23
DICTIONARY = MarkerDictionary.DICT_APRILTAG_36H11
DOT_MM, TAG_MM, PLAIN_MM = 3.0, 21.0, 3.0
"""Radius of coded dots, side of tags, radius of plain dots."""
COLUMNS, ROWS, _APART_MM = 7, 6, 29.0
_MIDDLE_MM = np.array([20.0, 0.0, 560.0])
_RADIUS_MM = 260.0
"""Of the cylinder that the marks lie on."""
_TURN_RAD = 0.35
_BLUR_PX, _NOISE = 0.8, 0.01
_FINER = finer(_BLUR_PX)


@dataclass(frozen=True)
class Specimen:
    """Pictures of a specimen, and the places of its marks.

    Attributes
    ----------
    rig : Rig
        The true cameras.
    pictures : dict of str to ndarray of uint8
        By camera.
    named : dict of str to ndarray, shape (3,)
        True places of coded dots' centres and tags' corners by name, mm.
    plain : ndarray, shape (n, 3)
        True places of plain dots' centres, mm.
    """

    rig: Rig
    pictures: dict[str, np.ndarray]
    named: dict[str, np.ndarray]
    plain: np.ndarray


@dataclass(frozen=True)
class _Patch:
    """A flat mark in space: its middle, two unit vectors in its plane (x, y up), and its ink by x, y, mm."""

    middle: np.ndarray
    across: np.ndarray
    up: np.ndarray
    reach_mm: float
    ink: Callable[[np.ndarray, np.ndarray], np.ndarray]


def specimen(number: int, seed: int, columns: int = COLUMNS, rows: int = ROWS) -> Specimen:
    """Draw one specimen: a third of coded dots, of tags and of plain dots, on a cylinder.

    Parameters
    ----------
    number : int
        Of the specimen.
    seed : int
    columns, rows : int
        Marks along and across it.
    """
    random = generator(seed, "bench marks", f"specimen {number}")
    rig = examples.rig().model_copy(update={"calibration": CalibrationRecord(scatter_px=0.0)})
    book = code_book(CODE)
    codes, tags = random.permutation(CODE.size), random.permutation(DICTIONARY.size)
    turn = random.uniform(-_TURN_RAD, _TURN_RAD)
    patches: list[_Patch] = []
    named: dict[str, np.ndarray] = {}
    plain = []
    for k in range(columns * rows):
        col, row = k % columns - 0.5 * (columns - 1), k // columns - 0.5 * (rows - 1)
        place = _placed(_APART_MM * np.array([col, row]), turn, random)
        kind = k % 3
        if kind == 0:
            mark = int(codes[k])
            patches.append(_Patch(*place, QUIET * DOT_MM, _coded(book.word(mark), random.uniform(0, 1))))
            named[f"{CODE}-{mark}"] = place[0]
        elif kind == 1:
            tag = int(tags[k])
            patches.append(_Patch(*place, TAG_MM, _tag(tag)))
            corners = 0.5 * TAG_MM * np.array([[-1, 1], [1, 1], [1, -1], [-1, -1]])
            for corner, (x, y) in enumerate(corners.tolist()):
                named[f"{tag_name(DICTIONARY)}-{tag}-{corner}"] = place[0] + x * place[1] + y * place[2]
        else:
            patches.append(_Patch(*place, 2.0 * PLAIN_MM, lambda x, y: (np.hypot(x, y) < PLAIN_MM) * 1.0))
            plain.append(place[0])
    pictures = {name: _drawn(rig.camera(name), patches, random) for name in rig.cameras}
    return Specimen(rig, pictures, named, np.array(plain))


def _placed(
    node: np.ndarray, turn: float, random: np.random.Generator
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return middle, x and y of a mark on a cylinder whose axis is turned in the picture."""
    x, y = node + random.uniform(-2.0, 2.0, 2)
    angle = x / _RADIUS_MM
    # The surface is nearest to the cameras in its middle.
    local = np.array([_RADIUS_MM * np.sin(angle), y, _RADIUS_MM * (1.0 - np.cos(angle))])
    axes = np.array([[np.cos(angle), 0.0, np.sin(angle)], [0.0, -1.0, 0.0]])
    R = np.array([[np.cos(turn), -np.sin(turn), 0.0], [np.sin(turn), np.cos(turn), 0.0], [0.0, 0.0, 1.0]])
    spin = random.uniform(-np.pi, np.pi)
    across = R @ (np.cos(spin) * axes[0] + np.sin(spin) * axes[1])
    up = R @ (-np.sin(spin) * axes[0] + np.cos(spin) * axes[1])
    return _MIDDLE_MM + R @ local, across, up


def _coded(word: np.ndarray, start: float) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the ink of a coded dot; sectors run clockwise as seen from the front."""

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        rho = np.hypot(x, y) / DOT_MM
        sector = np.floor((start - np.arctan2(y, x) / (2.0 * np.pi)) * len(word)).astype(int) % len(word)
        ring = (rho > RING_INNER) & (rho < RING_OUTER) & word[sector]
        return np.where((rho < 1.0) | ring, 1.0, 0.0)

    return ink


def _tag(number: int) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
    """Return the ink of a tag."""
    dictionary = opencv_dictionary(DICTIONARY)
    cells = dictionary.markerSize + 2
    black = dictionary.generateImageMarker(number, cells, borderBits=1) == 0

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        col, row = (np.floor(cells * (0.5 + place / TAG_MM)).astype(int) for place in (x, -y))
        inside = (col >= 0) & (col < cells) & (row >= 0) & (row < cells)
        return np.where(inside, black[np.clip(row, 0, cells - 1), np.clip(col, 0, cells - 1)], 0.0)

    return ink


def _on_patch(
    camera: Camera, patch: _Patch, low: np.ndarray, high: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Return x and y on a mark, mm, of all samples of the pixels from `low` to `high`.

    Rays are computed at pixels, and their places interpolated: over a pixel these are as good as linear.
    """
    shape = (high - low + 3)[::-1]
    rows, columns = np.indices(shape).reshape(2, -1)
    ray = camera.rays(np.stack([columns + low[0] - 1.0, rows + low[1] - 1.0], axis=-1))
    normal = np.cross(patch.across, patch.up)
    depth = ((patch.middle - ray.origin) @ normal) / (ray.direction @ normal)
    at = ray.origin + depth[:, None] * ray.direction - patch.middle
    x, y = (
        cv2.resize((at @ axis).reshape(shape), None, fx=_FINER, fy=_FINER, interpolation=cv2.INTER_LINEAR)
        for axis in (patch.across, patch.up)
    )
    inner = slice(_FINER, -_FINER)
    return x[inner, inner], y[inner, inner]


def _drawn(camera: Camera, patches: list[_Patch], random: np.random.Generator) -> np.ndarray:
    """Return the picture of flat marks on white: each pixel the mean of samples, blurred, with noise."""
    width, height = camera.size
    fine = np.full((_FINER * height, _FINER * width), PAPER)
    for patch in patches:
        rim = patch.middle + patch.reach_mm * 1.5 * np.array(
            [
                patch.across + patch.up,
                patch.across - patch.up,
                -patch.across + patch.up,
                -patch.across - patch.up,
            ]
        )
        q = camera.project(rim).q
        low = np.maximum(np.floor(q.min(axis=0)).astype(int), 0)
        high = np.minimum(np.ceil(q.max(axis=0)).astype(int), [width - 1, height - 1])
        if not np.isfinite(q).all() or (high < low).any():
            continue
        ink = patch.ink(*_on_patch(camera, patch, low, high))
        part = fine[_FINER * low[1] : _FINER * (high[1] + 1), _FINER * low[0] : _FINER * (high[0] + 1)]
        part += np.minimum(0.0, PAPER + (INK - PAPER) * ink - part)
    fine = cv2.GaussianBlur(fine, (0, 0), _BLUR_PX * _FINER, borderType=cv2.BORDER_REPLICATE)
    clean = fine.reshape(height, _FINER, width, _FINER).mean(axis=(1, 3))
    noisy = 255.0 * (clean + _NOISE * np.sqrt(clean) * random.standard_normal(clean.shape))
    return np.asarray(np.clip(np.rint(noisy), 0, 255).astype(np.uint8))
