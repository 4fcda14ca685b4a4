"""The first look at a shoot: the tone curve of each camera, and by how much dots are printed too large."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from labcal.cameras.dot_image import dot_images
from labcal.guide.twin.again import GROWTH, RenderedAgain, TwinJob, rendered_again, rendered_share
from labcal.guide.twin.dot_windows import DotWindows, dot_windows
from labcal.shoot.tone_curve import ToneCurve

CURVES = (ToneCurve.LINEAR, ToneCurve.SRGB, ToneCurve.REC709)
"""Those that are tried; the power 1 / 2.2 is sRGB's but for the darkest values."""
_BETTER = 0.9
"""Of what the straight curve leaves; a picture that hardly tells is taken for light as it is."""


@dataclass(frozen=True)
class FirstLook:
    """Properties of all pictures of a camera, by one of them.

    Attributes
    ----------
    camera : str
    curve : ToneCurve
        The curve under which paper, ink, blur and size explain the edges of dots best.
    growth_mm : float
        Growth of the radius of dots beyond the print as it was given.
    """

    camera: str
    curve: ToneCurve
    growth_mm: float


def first_look(job: TwinJob) -> FirstLook:
    """Return the tone curve and the growth of dots that one picture tells.

    Parameters
    ----------
    job : TwinJob
        Its curve does not matter.

    Raises
    ------
    InputError, DeviceError
        As of rendering it again.
    """
    sharp = rendered_share(job)
    tried = [(curve, rendered_again(replace(job, curve=curve), sharp)) for curve in CURVES]
    if tried[0][1].stored.kind == "float32":
        tried = tried[:1]
    left = [_left(made) for _, made in tried]
    best = int(np.argmin(left))
    curve, made = tried[best if left[best] < _BETTER * left[0] else 0]
    return FirstLook(job.source.camera, curve, _growth_mm(job, made.windows))


def joint_growth(looks: Sequence[FirstLook]) -> float:
    """Return the growth of dots that several cameras tell, mm."""
    return float(np.median([look.growth_mm for look in looks]))


def _left(made: RenderedAgain) -> float:
    """Return what light, place, blur and size leave of the squared differences of stored values at edges.

    To first order a difference of stored values is one of light over the steps of light between values.
    """
    light, channel = made.light[made.main], made.photo[made.main]
    step = 12.0 * made.stored.step_variance(light.image(made.behind.share))
    variance = np.maximum(step, np.float32(1e-6)) if step.any() else np.ones_like(step)
    found = dot_windows(channel, variance, made.seen(), light, made.around)
    return float((found.squares.sum() - found.removed.sum()) / max(1, found.pixels.sum()))


def _growth_mm(job: TwinJob, windows: DotWindows) -> float:
    """Return the median growth of dots, px, over the px of a mm of each."""
    target = job.known.target
    radii = 0.5 * target.outer_diameters_mm()[job.dots]
    images = dot_images(job.camera, job.T_world_target, job.known.dots[job.dots], radii)
    outline = images.outline[images.ok]
    away = outline - outline.mean(axis=1, keepdims=True)
    radius_px = np.sqrt((away**2).sum(axis=-1).mean(axis=1))
    growth = windows.parameters[:, GROWTH] * radii[images.ok] / radius_px
    known = growth[np.isfinite(growth)]
    return float(np.median(known)) if len(known) else 0.0
