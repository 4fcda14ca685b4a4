"""The scale of the print as another explanation of new views: a shift along the baseline looks the same."""

from dataclasses import dataclass, replace

import numpy as np

from labcal.calibrate.validity.evidence import NewViews
from labcal.calibrate.validity.explanation import Explanation, explained
from labcal.calibrate.validity.tested import Tested
from labcal.distributions import gain_tail

PRINTED = 2e-3
"""Standard deviation of the relative scale of a print, before pictures are seen: printers stretch paper."""
CHANCE = 1e-3
"""Probability of an improvement by chance, below which a scale is an explanation at all."""
_FIRST_STEP, _SHRINKS, _ROUNDS = 1e-3, 0.1, 2
"""Half of the first interval of scales, the ratio of the next one to it, and their number."""


@dataclass(frozen=True)
class PrintScale:
    """A print of another scale than the declared one, which explains new views with the rig as it was.

    Attributes
    ----------
    ppm, sigma_ppm : float
        Larger than declared by so many parts per million.
    probability : float
        That this is it, given that either the rig changed or the print is another one; all kinds of changes
        and this one are as likely before.
    """

    ppm: float
    sigma_ppm: float
    probability: float


def print_scale(found: Tested) -> PrintScale | None:
    """Return the scale of the print that explains new views best.

    Parameters
    ----------
    found : Tested
        A rig that has changed.

    Returns
    -------
    PrintScale or None
        None of fixed marks, of one camera, and where no scale is an explanation.

    Notes
    -----
    The cost of the unchanged rig is a parabola of the scale near its minimum, which three scales determine.
    Its evidence is compared with those of the changes, with Occam's factor of the one parameter.
    """
    if not isinstance(found.made.views, NewViews) or len(found.made.cameras) == 1:
        return None
    scale, step, curvature = 0.0, _FIRST_STEP, 0.0
    for _ in range(_ROUNDS):
        costs = []
        for one in (scale - step, scale, scale + step):
            tried = _with_scale(found, one)
            if tried is None:
                return None
            costs.append(tried.cost)
        curvature = (costs[0] - 2.0 * costs[1] + costs[2]) / step**2
        if not curvature > 0.0:
            return None
        scale += float(np.clip(0.5 * (costs[0] - costs[2]) / (curvature * step), -10.0 * step, 10.0 * step))
        step *= _SHRINKS
    best = _with_scale(found, scale)
    if best is None:
        return None
    gain = found.unchanged.cost - best.cost - (scale / PRINTED) ** 2
    if gain_tail(gain, 1, found.made.noise_freedom) > CHANCE:
        return None
    half = 0.5 * curvature  # the cost grows by half of it times the square of the scale's error
    prior = (scale / PRINTED) ** 2 + np.log1p(PRINTED**2 * half)
    others = np.array([one.log_evidence for one in found.changed])
    log_evidence = best.log_evidence - 0.5 * prior
    share = float(1.0 / (1.0 + np.exp(np.clip(others - log_evidence, -700.0, 700.0)).sum()))
    sigma = 1.0 / np.sqrt(half + PRINTED**-2)
    return PrintScale(1e6 * scale, 1e6 * float(sigma), share)


def _with_scale(found: Tested, scale: float) -> Explanation | None:
    """Return the explanation of the views by the rig as it was and a print of a scale."""
    made, start = found.made, found.unchanged.evidence.state
    state = replace(made.calibrated.state, dots=(1.0 + scale) * made.calibrated.state.dots)
    state = replace(state, T_world_target=start.T_world_target)
    calibrated = replace(made.calibrated, state=state)
    floor = min(one.cost for one in found.changed)
    return explained(calibrated, None, made.views, floor, found.unchanged.errors)
