"""A perspective lens model that images like an equidistant fisheye, as a start for strong distortion."""

from dataclasses import replace

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.lens import LENGTH, lens_by_name

_ANGLES = 200
_WIDEST = np.radians(78.0)
"""Of the angles that are fitted: beyond, the tangent grows out of the reach of polynomials."""
_ABOVE, _BELOW = ("k1", "k2", "k3"), ("k4", "k5", "k6")


def as_perspective(equidistant: Camera, lens: str, widest: float) -> Camera:
    """Return a camera with a perspective lens model whose radial coefficients image angles proportionally.

    Parameters
    ----------
    equidistant : Camera
        Radii in its picture are proportional to angles; its focal length and principal point are kept.
    lens : str
        One of OpenCV's perspective lens models.
    widest : float
        Largest angle between an axis and a dot's ray, rad.

    Notes
    -----
    With the radius r = tan a of a field point, the image's radius a and the model's numerator and
    denominator, a (1 + k4 r^2 + k5 r^4 + k6 r^6) = r (1 + k1 r^2 + k2 r^4 + k3 r^6) is linear in the
    coefficients: least squares.
    """
    model = lens_by_name(lens)
    angle = np.linspace(0.0, min(widest, _WIDEST), _ANGLES + 1)[1:]
    r = np.tan(angle)
    above = [r ** (2 * power + 3) for power, name in enumerate(_ABOVE) if name in model.names]
    below = [-angle * r ** (2 * power + 2) for power, name in enumerate(_BELOW) if name in model.names]
    dist = np.zeros(max(LENGTH, model.coefficients))
    if above:
        columns = np.stack(above + below, axis=1)
        columns, right = columns / r[:, None], (angle - r) / r
        found = np.linalg.lstsq(columns, right, rcond=None)[0]
        names = [name for name in (*_ABOVE, *_BELOW) if name in model.names]
        for name, value in zip(names, found.tolist(), strict=True):
            dist[model.names.index(name)] = value
    return replace(equidistant, lens=lens, dist=dist)
