"""A sensor's gain, dark noise and saturation from its own flat-field readings: the photon transfer method."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, UInt16

from labcal.errors import InputError

Pair = UInt16[np.ndarray, "2 h w"]
"""Two readings of the same even light, DN."""
Steps = Float64[np.ndarray, " steps"]

QUANTISATION = 1.0 / 12.0
"""Variance of a converter's steps, DN^2."""
LEAST_NOISE = 0.6
"""Noise, DN, from which a converter's steps add 1/12 DN^2 to the variance to 0.4% of the noise's own."""
LINEAR_SHARE = 0.7
"""EMVA 1288 fits the curve up to 70% of the saturation."""
SATURATED = 0.1
"""At saturation the variance is below this share of its maximum."""
CLIPPED = 1e-3
"""Share of dark readings at code 0 from which the dark noise is cut off."""


@dataclass(frozen=True)
class PhotonTransfer:
    """The results of the photon transfer curve of a sensor, each with its standard error.

    Attributes
    ----------
    gain_dn_per_e : float
        System gain K.
    read_noise_e : float
        Temporal dark noise sigma_d, electrons. NaN if quantisation hides it.
    full_well_e : float
        Saturation capacity mu_e.sat, electrons.
    mean_dn, variance_dn2 : ndarray, shape (steps,)
        The curve: mean over that of the dark, and temporal variance with that of the steps taken off. The
        dark is the first step.
    """

    gain_dn_per_e: float
    gain_error: float
    read_noise_e: float
    read_noise_error: float
    full_well_e: float
    full_well_error: float
    mean_dn: Steps
    variance_dn2: Steps


def photon_transfer(dark: Pair, ladder: Sequence[Pair]) -> PhotonTransfer:
    """Measure a sensor by the photon transfer method of EMVA 1288 (Release 4 Linear).

    The temporal variance of a step is half that of the difference of its two readings, so that light which
    is not even, PRNU and DSNU fall out; the converter's 1/12 DN^2 is subtracted. What is left is
    ``K (mean - dark mean) + K^2 sigma_d^2``, and a straight line is fitted up to 70% of the saturation.

    Two things differ from the standard. The steps weigh by the inverse variance of their variance, so that
    the line's value at no light is as good as that of the dark alone; and steps with less than 0.6 DN of
    noise, the dark too, are left out, since the converter's steps then add no constant 1/12. A coarse
    converter is measured from brighter steps in that way, where the standard gives an upper limit.

    The saturation capacity is the mean reading where every pixel is saturated. The standard takes the mean
    at the curve's maximum, which lies some 2.5 standard deviations of the photon noise below: 1% at a full
    well of 50 000 electrons, 3% at 6000.

    Parameters
    ----------
    dark : ndarray of uint16, shape (2, h, w)
        Two readings without light.
    ladder : sequence of ndarray of uint16, shape (2, h, w)
        Two readings at each of several exposures, from near the dark to a saturation of every pixel.

    Raises
    ------
    InputError
        The noise of the dark is cut off at code 0, no exposure saturates the sensor, or fewer than three are
        of use for the line.
    """
    if float((dark == 0).mean()) > CLIPPED:
        raise InputError(
            "The dark readings are cut off at code 0, which hides their noise. Raise black_level_dn."
        )
    steps = [dark, *ladder]
    mean = np.array([step.mean() for step in steps])
    mean -= mean[0]
    raw_variance = np.array([_temporal_variance(step) for step in steps])
    variance = raw_variance - QUANTISATION
    saturated = int(np.argmax(mean))
    if variance[saturated] > SATURATED * variance.max():
        raise InputError(
            "The brightest exposure does not saturate every pixel: its variance is "
            f"{variance[saturated]:.3g} DN^2 and the highest {variance.max():.3g} DN^2. Add a brighter one."
        )
    used = (mean <= LINEAR_SHARE * mean[saturated]) & (variance >= LEAST_NOISE**2)
    if used.sum() < 3:  # noqa: PLR2004 -- two parameters and one to spare
        raise InputError(
            f"Only {used.sum()} exposures lie below {LINEAR_SHARE:.0%} of the saturation with at least "
            f"{LEAST_NOISE:g} DN of noise; 3 are needed. Add some."
        )
    error = raw_variance[used] * np.sqrt(2.0 / (dark[0].size - 1))
    design = np.stack([mean[used], np.ones(used.sum())], axis=-1) / error[:, None]
    covariance = np.linalg.inv(design.T @ design)
    gain, floor = covariance @ design.T @ (variance[used] / error)
    # The dark noise is sqrt(floor) / gain; its error follows from the line's two errors.
    noise = np.sqrt(floor) / gain if floor > 0.0 else np.nan
    slope = np.array([-noise / gain, 0.5 * noise / floor])
    full_well = mean[saturated] / gain
    gain_error = float(np.sqrt(covariance[0, 0]))
    return PhotonTransfer(
        gain_dn_per_e=float(gain),
        gain_error=gain_error,
        read_noise_e=float(noise),
        read_noise_error=float(np.sqrt(slope @ covariance @ slope)),
        full_well_e=float(full_well),
        full_well_error=float(full_well * gain_error / gain),
        mean_dn=mean,
        variance_dn2=variance,
    )


def _temporal_variance(pair: Pair) -> float:
    """Return half the variance of the difference of two readings, DN^2."""
    return 0.5 * float((pair[0].astype(np.float64) - pair[1]).var(ddof=1))
