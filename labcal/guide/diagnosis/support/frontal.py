"""Tilt of a target in a picture, from its dots alone: how much larger one side looks than the other."""

import cv2
import numpy as np

from labcal.arrays import Pixels, Vectors3

_FEWEST = 8


def change_of_scale(q: Pixels, p: Vectors3) -> float:
    """Return the relative change of scale over the target along its steepest direction.

    0 for a target that faces the camera; about ``2 r / d sin(tilt)`` for one of radius r at the distance d.
    NaN where dots do not tell.

    Parameters
    ----------
    q : ndarray, shape (n, 2)
        Dots in a picture, px.
    p : ndarray, shape (n, 3)
        The same on the target, mm.
    """
    if len(q) < _FEWEST:
        return float("nan")
    middle = p[:, :2].mean(axis=0)
    radius = float(np.linalg.norm(p[:, :2] - middle, axis=1).max())
    H, _ = cv2.findHomography((p[:, :2] - middle) / radius, q)
    if H is None or not np.isfinite(H).all():
        return float("nan")
    return float(2.0 * np.hypot(H[2, 0], H[2, 1]) / abs(H[2, 2]))
