"""What a camera makes of the light on its sensor: exposure, noise, converter, colour, tone curve, 8 bits."""

from dataclasses import dataclass

import cv2
import numpy as np

from labcal.render.demosaic import demosaic, mosaic
from labcal.scene.lighting import REC709
from labcal.scene.photometry import Photometry, ToneCurve

SRGB_KNEE = 0.0031308


@dataclass(frozen=True)
class Exposure:
    """The settings a photographer makes once for all pictures of a scene."""

    gain: float
    """Share of the sensor's full scale per unit of radiance."""
    balance: tuple[float, float, float]
    """Factors of red, green and blue that make a bare board grey; the least is 1."""


def exposure_for(photometry: Photometry, brightest: np.ndarray) -> Exposure:
    """Return the exposure under which a bare board nowhere exceeds ``photometry.white``.

    Parameters
    ----------
    photometry : Photometry
    brightest : ndarray, shape (3,)
        Highest radiance of the bare board in the scene, red, green and blue.
    """
    if not photometry.bayer:
        return Exposure(photometry.white / float(REC709 @ brightest), (1.0, 1.0, 1.0))
    strongest = float(brightest.max())
    red, green, blue = (strongest / float(channel) for channel in brightest)
    return Exposure(photometry.white / strongest, (red, green, blue))


def expose(light: np.ndarray, photometry: Photometry, exposure: Exposure) -> np.ndarray:
    """Return the light on the sensor, after the point spread, as a share of the full scale (float32)."""
    if photometry.blur_px > 0.0:
        light = cv2.GaussianBlur(light, (0, 0), photometry.blur_px, borderType=cv2.BORDER_REPLICATE)
    return light * np.float32(exposure.gain)


def read_sensor(share: np.ndarray, photometry: Photometry, random: np.random.Generator | None) -> np.ndarray:
    """Return the converter's reading of an exposed sensor.

    Parameters
    ----------
    share : ndarray, shape (height, width)
        Mean signal as a share of the full scale.
    photometry : Photometry
    random : numpy.random.Generator or None
        Draws photon noise (Poisson) and read noise (Gauss); none: the mean signal is converted.

    Returns
    -------
    ndarray, shape (height, width)
        Reading over the highest code, 0 to 1, in steps of the converter.
    """
    electrons = np.clip(share, 0.0, None).astype(np.float64) * photometry.full_well_e
    if random is not None:
        electrons = random.poisson(electrons) + random.normal(0.0, photometry.read_noise_e, electrons.shape)
    highest = 2**photometry.adc_bits - 1
    reading: np.ndarray = np.clip(np.rint(electrons / photometry.full_well_e * highest), 0, highest) / highest
    return reading


def tone(linear: np.ndarray, curve: ToneCurve) -> np.ndarray:
    """Return a linear picture (0 to 1) after the tone curve; sRGB after IEC 61966-2-1."""
    if curve is ToneCurve.LINEAR:
        return linear
    return np.where(
        linear <= SRGB_KNEE,
        12.92 * linear,
        1.055 * np.maximum(linear, SRGB_KNEE) ** (1.0 / 2.4) - 0.055,
    )


def develop(
    share: np.ndarray, photometry: Photometry, exposure: Exposure, random: np.random.Generator | None
) -> np.ndarray:
    """Return the picture that a camera delivers.

    Parameters
    ----------
    share : ndarray, shape (height, width) or (height, width, 3)
        The light of :func:`expose`; three colours where the sensor has a Bayer mosaic.
    photometry : Photometry
    exposure : Exposure
    random : numpy.random.Generator or None
        For the sensor's noise; none: a sensor without noise.

    Returns
    -------
    ndarray of uint8, of the shape of `share`
    """
    if not photometry.bayer:
        picture = read_sensor(share, photometry, random)
    else:
        reading = read_sensor(mosaic(share), photometry, random)
        red, green, blue = exposure.balance
        balance = np.full(reading.shape, green)
        balance[0::2, 0::2] = red
        balance[1::2, 1::2] = blue
        picture = demosaic(reading * balance)
    return np.rint(255.0 * tone(np.clip(picture, 0.0, 1.0), photometry.tone_curve)).astype(np.uint8)
