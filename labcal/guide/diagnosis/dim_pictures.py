"""Pictures that are darker than others of a shoot, and measure their dots worse for it."""

from dataclasses import dataclass

import numpy as np

from labcal.guide.diagnosis.evidence import Evidence
from labcal.guide.diagnosis.finding import LEAST_HARM
from labcal.guide.picture_look import PictureLook

_DARKER = 0.75
"""Level of paper over that of right pictures below which one is darker: a stop, with the curve of sRGB."""
_BRIGHT = 75.0
"""Percentile of the levels of paper that is the right one."""
_POWER = 0.75
"""Of the standard deviation of a dot by its size: half that of the variance in the dots' noise model."""
_SCATTERS = 3.0
"""Robust standard deviations of right pictures that the noise of one is beyond chance."""
_FEWEST = 3
"""Right pictures to compare with."""


@dataclass(frozen=True)
class _Judged:
    """A picture: its camera, paper, and stated error of its dots, brought to one size of dots."""

    image: str
    camera: str
    look: PictureLook
    sigma: float


def dim_pictures(evidence: Evidence, camera: str) -> dict[str, float]:
    """Return the pictures of a camera whose darkness costs noise, by path, with the relative increase of it.

    Pictures of one size are compared, those of other cameras among them: a whole set that is too dark has
    nothing else to be compared with. Darker ones are judged together, by their median.

    Parameters
    ----------
    evidence : Evidence
    camera : str
    """
    judged = _judged(evidence)
    own = [one for one in judged if one.camera == camera]
    if not own:
        return {}
    alike = [one for one in judged if one.look.size == own[0].look.size]
    level = _DARKER * float(np.percentile([one.look.paper for one in alike], _BRIGHT))
    dim = [one for one in own if one.look.paper < level]
    right = [one for one in own if one.look.paper >= level]
    if len(right) < _FEWEST:
        right = [one for one in alike if one.look.paper >= level]
    if not dim or len(right) < _FEWEST:
        return {}
    usual = np.log([one.sigma for one in right])
    scatter = 1.4826 * float(np.median(np.abs(usual - np.median(usual)))) / np.sqrt(len(dim))
    more = float(np.median(np.log([one.sigma for one in dim])) - np.median(usual))
    if more < np.log1p(LEAST_HARM) or more < _SCATTERS * scatter:
        return {}
    return {one.image: float(np.expm1(more)) for one in dim}


def _judged(evidence: Evidence) -> list[_Judged]:
    """Return the pictures that are exposed as a picture by itself can be, with measured dots."""
    found = []
    for one, look in zip(evidence.measurements, evidence.looks, strict=True):
        if one.dots is None or look is None or look.exposure_words is not None or look.refusal is not None:
            continue
        outline = one.dots.outline[one.dots.ok]
        area = np.linalg.det(outline[np.isfinite(outline).all(axis=(1, 2))])  # corners have none
        size = float(np.median(np.maximum(area, 0.0) ** 0.25)) if len(area) else float("nan")
        sigma = look.sigma_px * size**_POWER
        if np.isfinite(sigma) and sigma > 0.0:
            found.append(_Judged(one.source.image, one.source.camera, look, sigma))
    return found
