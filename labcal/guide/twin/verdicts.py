"""The verdict on each picture of a twin: what of it is not at noise level."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.guide.twin.again import BLUR
from labcal.guide.twin.picture import TwinPicture
from labcal.guide.twin.residuals import DotResiduals, rms

_SIGMAS = 4.0
"""A figure of one picture is named where it is farther off than chance lets one in ten thousand be."""
BLUR_SHARE = 0.15
"""Of the usual blur of a camera; less changes no measurement."""
LOUD = 1.25
"""Mean squared difference of pixels, in units of the noise, from which on a picture is not at noise level."""


@dataclass(frozen=True)
class PictureVerdict:
    """The verdict on one picture.

    Attributes
    ----------
    view, camera : str
    rms_px, noise_px : float
        RMS residual of dots, photograph minus rendering, and that of noise alone; 2-D.
    level : float
        Mean squared residual in units of noise; 1 is noise alone.
    findings : tuple of str
        What is not at noise level, for people; empty where all is.
    """

    view: str
    camera: str
    rms_px: float
    noise_px: float
    level: float
    findings: tuple[str, ...]


def picture_verdicts(
    pictures: Sequence[TwinPicture], found: DotResiduals, freedom_share: float
) -> tuple[PictureVerdict, ...]:
    """Return the verdict on every picture.

    Parameters
    ----------
    pictures : sequence of TwinPicture
    found : DotResiduals
    freedom_share : float
        Degrees of freedom of residuals over their number: the rest went into what was fitted to them.
    """
    usual = usual_blur(pictures)
    square = found.squares()
    verdicts = []
    for number, made in enumerate(pictures):
        mine = found.picture == number
        freedom = max(1.0, 2.0 * float(mine.sum()) * freedom_share)
        level = float(square[mine].sum()) / freedom if mine.any() else float("nan")
        findings = []
        if level > 1.0 + _SIGMAS * np.sqrt(2.0 / freedom):
            findings.append(f"dots are {np.sqrt(level):.2g} times as far off as noise makes them")
        if is_unusual(made, usual[made.camera]):
            findings.append(
                f"edges are blurred by {made.blur_px:.2f} px, usual for this camera are "
                f"{usual[made.camera]:.2f} px"
            )
        if made.pixels.flat_variance > LOUD:
            findings.append(
                f"paper and ink differ by {np.sqrt(made.pixels.flat_variance):.2g} times the noise"
            )
        if made.pixels.edge_variance > max(LOUD, LOUD * made.pixels.flat_variance):
            findings.append(f"edges differ by {np.sqrt(made.pixels.edge_variance):.2g} times the noise")
        noise = np.trace(found.covariance[mine], axis1=1, axis2=2)
        by_noise = float(np.sqrt(noise.mean())) if mine.any() else float("nan")
        off = rms(found.residual[mine])
        verdicts.append(PictureVerdict(made.view, made.camera, off, by_noise, level, tuple(findings)))
    return tuple(verdicts)


def usual_blur(pictures: Sequence[TwinPicture]) -> dict[str, float]:
    """Return the median blur of each camera, px."""
    cameras = dict.fromkeys(made.camera for made in pictures)
    return {
        name: float(np.median([made.blur_px for made in pictures if made.camera == name])) for name in cameras
    }


def is_unusual(made: TwinPicture, usual: float) -> bool:
    """Tell whether the blur of a picture is not the one of its camera."""
    sigma = made.windows.sigma[:, BLUR]
    known = sigma[np.isfinite(sigma)]
    chance = float(np.median(known)) / np.sqrt(len(known)) if len(known) else np.inf
    return abs(made.blur_px - usual) > max(BLUR_SHARE * usual, _SIGMAS * chance)
