"""Map from the pixels of an ideal camera to those of a real one."""

import numpy as np
from jaxtyping import Float32

from labcal.cameras.camera import Camera
from labcal.errors import InputError

_ROWS_AT_ONCE = 2**18
"""Pixels that are traced at a time, which bounds the memory."""


def source_pixels(
    camera: Camera, ideal: Camera, distance_mm: float | None = None
) -> Float32[np.ndarray, "height width 2"]:
    """Return where the camera sees what the pixels of an ideal camera at its place look at.

    Parameters
    ----------
    camera : Camera
        The one that took the pictures.
    ideal : Camera
        At the same place.
    distance_mm : float, optional
        How far away, along the ideal camera's rays, the map holds. Central and parallel rays need none.

    Returns
    -------
    ndarray of float32, shape (height, width, 2)
        x and y in the camera's picture, px; NaN where it does not image the direction.

    Raises
    ------
    InputError
        The camera's rays do not meet in a point, and no distance is given.
    """
    if distance_mm is None and not camera.optics.closed:
        raise InputError(
            "The rays of a camera with a lens prescription or a flat window do not meet in one point, so no "
            "pinhole sees what it sees at every distance. Give one: `distance_mm`."
        )
    width, height = ideal.size
    found = np.empty((height, width, 2), dtype=np.float32)
    rows = max(1, _ROWS_AT_ONCE // width)
    for top in range(0, height, rows):
        v, u = np.mgrid[top : min(top + rows, height), 0:width].astype(np.float64)
        rays = ideal.rays(np.stack([u, v], axis=-1))
        p = rays.origin + (1.0 if distance_mm is None else distance_mm) * rays.direction
        found[top : top + rows] = camera.project(p).q
    return found
