"""Flat-field readings of a described sensor for the photon transfer method."""

import numpy as np

from labcal.render.sensor_response import Exposure, Shot, read_sensor
from labcal.scene.photometry import Photometry

SHARES = tuple(float(share) for share in np.geomspace(0.001, 0.7, 20))
"""Exposures as shares of the saturation; none brighter is of use but one that saturates."""
SATURATING = 1.5
"""Exposure of the darkest pixel, in saturations, at which each is saturated whatever its sensitivity."""
SHORTEST_MS = 0.01
"""Exposure time. EMVA 1288 states the dark noise at the shortest, where dark current adds nothing."""


def flat_fields(light: np.ndarray, photometry: Photometry, seed: int) -> tuple[np.ndarray, list[np.ndarray]]:
    """Read a sensor twice in the dark and twice at each of a ladder of exposures.

    Parameters
    ----------
    light : ndarray of float32, shape (height, width), or (height, width, 3) for a Bayer mosaic
        A picture of something evenly bright, in any unit.
    photometry : Photometry
        Its exposure is set here.
    seed : int
        Seed of the run.

    Returns
    -------
    dark : ndarray of uint16, shape (2, height, width)
        DN.
    ladder : list of ndarray of uint16, shape (2, height, width)
        From dark to bright; the last is saturated in every pixel.
    """
    short = photometry.model_copy(update={"exposure_ms": SHORTEST_MS})
    gains = [share / float(light.mean()) for share in (0.0, *SHARES)] + [SATURATING / float(light.min())]
    dark, *ladder = (
        np.stack(
            [
                read_sensor(light, short, Exposure(gain, (1.0, 1.0, 1.0)), Shot(seed, view, "flat-field"))
                for view in (f"step-{number}-a", f"step-{number}-b")
            ]
        )
        for number, gain in enumerate(gains)
    )
    return dark, ladder
