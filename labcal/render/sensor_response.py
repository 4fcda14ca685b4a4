"""The sensor of a camera: from light to codes of the converter, in the terms of EMVA 1288.

The linear model of EMVA 1288 (Release 4 Linear): a pixel gathers mu_e electrons on average, of which the dark
signal mu_d is a part; their number is Poisson's, so its variance is mu_e; the electronics add the temporal
dark noise sigma_d0; the system gain K (DN per electron) and the converter, whose steps have the variance
sigma_q^2 = 1/12 DN^2, make the code y of it:

    mu_y = mu_y.dark + K mu_e,    sigma_y^2 = K^2 (sigma_d^2 + mu_e) + sigma_q^2.

From pixel to pixel the sensitivity varies by PRNU and the dark signal by DSNU; both stay in every picture.
"""

from dataclasses import dataclass

import numpy as np

from labcal.render.bands import Band, bands
from labcal.render.demosaic import mosaic
from labcal.render.poisson_counts import poisson
from labcal.rng import generator
from labcal.scene.lighting import REC709
from labcal.scene.photometry import Photometry


@dataclass(frozen=True)
class Exposure:
    """The exposure settings of all pictures of a scene."""

    gain: float
    """Share of the sensor's saturation per unit of radiance."""
    balance: tuple[float, float, float]
    """Factors of red, green and blue that make a bare board grey; the least is 1."""


@dataclass(frozen=True)
class Shot:
    """The picture for which random numbers are drawn."""

    seed: int
    """Seed of the whole run."""
    view: str
    camera: str

    def temporal(self, band: Band) -> np.random.Generator:
        """Return the generator of the noise of this picture."""
        return generator(self.seed, self.view, self.camera, "sensor noise", f"row {band.first}")

    def pattern(self, kind: str, band: Band) -> np.random.Generator:
        """Return the generator of a fixed pattern of the camera, the same in all its pictures."""
        return generator(self.seed, self.camera, kind, f"row {band.first}")


def exposure_for(photometry: Photometry, brightest: np.ndarray) -> Exposure:
    """Return the exposure at which no bare board exceeds ``photometry.white``.

    ``photometry.exposure_stops`` brightens or darkens it from there. The exposure time takes no part: lamps
    and aperture are thought to suit it.

    Parameters
    ----------
    photometry : Photometry
    brightest : ndarray, shape (3,)
        Highest radiance of the bare board in the scene, red, green and blue.
    """
    white = photometry.white * 2.0**photometry.exposure_stops
    if not photometry.bayer:
        return Exposure(white / float(REC709 @ brightest), (1.0, 1.0, 1.0))
    strongest = float(brightest.max())
    red, green, blue = (strongest / float(channel) for channel in brightest)
    return Exposure(white / strongest, (red, green, blue))


def expose(light: np.ndarray, exposure: Exposure) -> np.ndarray:
    """Return the light on the sensor as a share of the saturation.

    Parameters
    ----------
    light : ndarray, shape (height, width) or (height, width, 3)
        Radiance that each pixel gathers, behind the point spread of the lens.
    exposure : Exposure

    Returns
    -------
    ndarray, float32, of the shape of `light`
    """
    share: np.ndarray = light * np.float32(exposure.gain)
    return share


def read_sensor(
    light: np.ndarray, photometry: Photometry, exposure: Exposure, shot: Shot | None
) -> np.ndarray:
    """Return the codes that the converter reads from an exposed sensor.

    In this order: exposure; photon noise with PRNU, and dark current; DSNU; full well; read noise; gain and
    black level; the converter's steps and range.

    Parameters
    ----------
    light : ndarray, shape (height, width), or (height, width, 3) for a Bayer mosaic
        Radiance that each pixel gathers, behind the point spread of the lens
        (:func:`labcal.render.point_spread.gathered`).
    photometry : Photometry
        Its point spread takes no part.
    exposure : Exposure
    shot : Shot or None
        What the noise is drawn for; none: the mean signal is converted, and there are no patterns.

    Returns
    -------
    ndarray of uint16, shape (height, width)
        DN.
    """
    codes = np.empty(light.shape[:2], dtype=np.uint16)
    for band in bands(len(light)):
        share = expose(light[band.rows], exposure)
        signal = np.maximum(mosaic(share) if photometry.bayer else share, np.float32(0))
        signal *= np.float32(photometry.saturation_e)
        electrons = _gathered(signal, photometry, shot, band)
        electrons *= np.float32(photometry.gain)
        electrons += np.float32(photometry.black_level_dn)
        np.rint(electrons, out=electrons)
        codes[band.rows] = np.clip(electrons, 0, photometry.highest_code, out=electrons)
    return codes


def _gathered(signal: np.ndarray, photometry: Photometry, shot: Shot | None, band: Band) -> np.ndarray:
    """Return the electrons that are read in a band with mean photo-electrons `signal`."""
    full_well = np.float32(photometry.full_well_e)
    if shot is None:
        return np.minimum(signal + np.float32(photometry.dark_e), full_well)
    if photometry.prnu > 0.0:
        sensitivity = _normal(shot.pattern("PRNU", band), signal.shape, photometry.prnu)
        sensitivity += np.float32(1)
        signal *= np.maximum(sensitivity, np.float32(0), out=sensitivity)
    temporal = shot.temporal(band)
    # Photo-electrons and dark electrons are both Poisson's, and so is their sum.
    electrons = poisson(signal + np.float32(photometry.dark_e), temporal)
    if photometry.dsnu_e > 0.0:
        electrons += _normal(shot.pattern("DSNU", band), signal.shape, photometry.dsnu_e)
    np.minimum(electrons, full_well, out=electrons)
    electrons += _normal(temporal, signal.shape, photometry.read_noise_e)
    return electrons


def _normal(random: np.random.Generator, shape: tuple[int, ...], deviation: float) -> np.ndarray:
    """Return normal random numbers with a standard deviation, float32."""
    numbers: np.ndarray = random.standard_normal(shape, dtype=np.float32)
    numbers *= np.float32(deviation)
    return numbers
