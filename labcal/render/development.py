"""The development of sensor codes into a delivered picture: colour, tone curve, 8 or 16 bits."""

import numpy as np

from labcal.render.bands import bands
from labcal.render.demosaic import HALO, demosaic
from labcal.render.sensor_response import Exposure
from labcal.scene.photometry import Photometry
from labcal.shoot.tone_curve import tone


def develop(codes: np.ndarray, photometry: Photometry, exposure: Exposure) -> np.ndarray:
    """Return the picture that a camera delivers.

    In this order: black level off; white balance on the mosaic; demosaicing; tone curve; 8 or 16 bits. A
    saturated pixel becomes white.

    Parameters
    ----------
    codes : ndarray of uint16, shape (height, width)
        What :func:`labcal.render.sensor_response.read_sensor` gives, DN.
    photometry : Photometry
    exposure : Exposure
        Its balance is that of the white.

    Returns
    -------
    ndarray of uint8 or uint16, shape (height, width), or (height, width, 3) for a Bayer mosaic
    """
    every_code = np.arange(photometry.highest_code + 1)
    scale = 1.0 / (photometry.gain * photometry.saturation_e)
    linear = (scale * (every_code - photometry.black_level_dn)).astype(np.float32)
    if not photometry.bayer:
        grey: np.ndarray = delivered(linear, photometry)[codes]
        return grey
    red, green, blue = (linear * np.float32(factor) for factor in exposure.balance)
    picture = np.empty((*codes.shape, 3), dtype=_kind(photometry))
    for band in bands(len(codes)):
        near = band.widened(codes, HALO)
        reading = green[near]
        reading[0::2, 0::2] = red[near[0::2, 0::2]]
        reading[1::2, 1::2] = blue[near[1::2, 1::2]]
        picture[band.rows] = delivered(band.narrowed(demosaic(reading), HALO), photometry)
    return picture


def delivered(linear: np.ndarray, photometry: Photometry) -> np.ndarray:
    """Return linear values (full scale at 1) as the camera delivers them, clipped to its range."""
    kind = _kind(photometry)
    values = tone(np.clip(linear, 0.0, 1.0), photometry.tone_curve)
    whole: np.ndarray = np.rint(np.iinfo(kind).max * values).astype(kind)
    return whole


def _kind(photometry: Photometry) -> type[np.uint8] | type[np.uint16]:
    """Return the type of the delivered values."""
    return np.uint8 if photometry.bits == 8 else np.uint16  # noqa: PLR2004 -- bits
