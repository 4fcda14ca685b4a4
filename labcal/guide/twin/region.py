"""The part of a picture that is compared: the cells of the dots that were measured in it."""

import cv2
import numpy as np
from jaxtyping import Bool, Int64

from labcal.arrays import Pose
from labcal.cameras.camera import Camera
from labcal.geometry.poses import transform
from labcal.targets.grid import DotGrid

_ALONG = 4
"""Points of each side of a cell; lenses bend them."""
_FINE = 4
"""Bits of a pixel in which polygons are filled."""


def compared_pixels(
    camera: Camera, T_world_target: Pose, target: DotGrid, dots: Int64[np.ndarray, " n"], margin_px: float
) -> Bool[np.ndarray, "h w"]:
    """Return a mask of the pixels in the cells of dots, away from the border of their union.

    A print may go on beyond the declared grid, and the floor, a hand or the wall behind it are not in the
    calibration: nothing there is compared.

    Parameters
    ----------
    camera : Camera
    T_world_target : ndarray, shape (4, 4)
        Mm.
    target : DotGrid
    dots : ndarray of int, shape (n,)
        Numbers of the dots.
    margin_px : float
        Distance from the border, px.
    """
    width, height = camera.size
    mask = np.zeros((height, width), dtype=np.uint8)
    cell = _cell(target)
    for x, y, z in target.points()[dots].tolist():
        seen = camera.project(transform(T_world_target, cell + np.array([x, y, z])))
        if seen.ok.all():
            polygon = np.rint(seen.q * 2**_FINE).astype(np.int32)
            cv2.fillPoly(mask, [polygon], 1, shift=_FINE)
    reach = max(1, int(np.ceil(margin_px)))
    around = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * reach + 1, 2 * reach + 1))
    closed = cv2.morphologyEx(mask, cv2.MORPH_CLOSE, np.ones((3, 3), dtype=np.uint8))
    return np.asarray(cv2.erode(closed, around, borderType=cv2.BORDER_CONSTANT, borderValue=0).astype(bool))


def _cell(target: DotGrid) -> np.ndarray:
    """Return the border of the cell of a dot about its centre, mm, within the margin of the board."""
    half_x, half_y = (0.5 * np.array(target.cell_mm)).tolist()
    if target.margin_mm > 0.0:  # where none is declared, the board is thought to go on
        half_x, half_y = min(half_x, target.margin_mm), min(half_y, target.margin_mm)
    s = np.linspace(-1.0, 1.0, _ALONG, endpoint=False)
    one = np.ones_like(s)
    sides = [(s, -one), (one, s), (-s, one), (-one, -s)]
    flat = np.concatenate([np.stack([half_x * x, half_y * y], axis=-1) for x, y in sides])
    return np.concatenate([flat, np.zeros((len(flat), 1))], axis=1)
