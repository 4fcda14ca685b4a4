"""The test whether views ask for a lens model with more coefficients than the one of their calibration."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.prior_term import LensPrior
from labcal.calibrate.adjustment.problem import AdjustmentProblem, ViewsEliminated
from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.adjustment.state import POSE, Lenses
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.print_share import PrintShare
from labcal.calibrate.budget.view_dispersion import ViewDispersion
from labcal.calibrate.lens_candidates import LARGE, PLENTY
from labcal.calibrate.lens_prior import PriorWidth
from labcal.calibrate.lens_start import camera_as_lens
from labcal.cameras.camera import Camera
from labcal.cameras.lens import lens_by_name
from labcal.cameras.opencv_model import PERSPECTIVE
from labcal.cameras.optics import INTRINSICS
from labcal.distributions import f_tail

CHANCE, CHANCE_OF_LARGE = 0.005, 1e-6
"""Most probable chance of coefficients that are not 0; the latter of :data:`LARGE` with few views.

Seven coefficients more follow the errors of a print through a few views: of 24 simulated cameras with long
lenses, 12 views and a print that was off by what the noise is, chance was 1e-5 and more."""
NESTED = ("pinhole", "brown-k1k2", "brown5", "rational8", LARGE)
"""Each contains those before it."""
_UNDAMPED = 1e-12


@dataclass(frozen=True)
class LensMisfit:
    """A larger lens model, whose further coefficients are not 0.

    Attributes
    ----------
    larger : str
        Name of the model.
    chance : float
        Probability that chance alone makes the coefficients so large.
    """

    larger: str
    chance: float


def lens_misfit(adjusted: Adjusted, observations: Observations) -> LensMisfit | None:
    """Return the larger lens model that one camera's views ask for; None where theirs suits.

    Tried are the next larger model that contains the lens, and the largest one.

    Parameters
    ----------
    adjusted : Adjusted
        Of one camera.
    observations : Observations
        Those that were adjusted: centroids.

    Notes
    -----
    A score test in the form of Wald's: one step of Gauss and Newton, in which everything follows, gives the
    coefficients that the lens does not have, beside their covariance (Rao 1948; Engle 1984). It holds the
    noise that residuals show, the errors of the print, and the dispersion of views at the end of the step,
    of which the degrees of freedom are those of the F distribution: light, blur and boards that bend move
    neighbouring dots alike, and look like a lens in any one view. The noise alone is tried first.

    Through a long lens the valley is curved, and a step goes beyond what it promised: coefficients count by
    the share of the expected decrease of the cost that the step really brought.
    """
    (camera,) = adjusted.state.cameras
    views = len(np.unique(observations.view))
    larger = larger_lenses(camera)
    if not larger or adjusted.layout.freedom.lenses is Lenses.FIXED:
        return None
    entered = Entered.of(adjusted, observations)
    sure = []
    for lens in larger:
        least = CHANCE_OF_LARGE if lens == LARGE and views < PLENTY else CHANCE
        chance = _chance(entered, lens, least)
        if chance < least:
            sure.append(LensMisfit(lens, chance))
    return min(sure, key=lambda one: one.chance, default=None)


def larger_lenses(camera: Camera) -> tuple[str, ...]:
    """Return the lens models that are tried, each of which contains the camera's; often none."""
    if camera.model.opencv is not PERSPECTIVE:
        return ()
    own = camera.model.coefficients
    more = [lens for lens in NESTED if lens_by_name(lens).coefficients > own]
    return tuple(dict.fromkeys((*more[:1], *more[-1:])))


def _chance(entered: Entered, lens: str, least: float) -> float:
    """Return the probability that chance makes the further coefficients of a lens model so large.

    Above `least`, it is the one by the noise alone.
    """
    (camera,) = entered.state.cameras
    own, all_ = camera.model.coefficients, lens_by_name(lens).coefficients
    at, more = slice(INTRINSICS + own, INTRINSICS + all_), all_ - own
    step = _stepped(entered, camera_as_lens(camera, lens, ""))
    if step is None:
        return 1.0
    larger, end, gain = step
    found = larger.state.cameras[0].dist[own:all_]
    cameras = end.shared_spread()[: end.layout.pose[-1].stop, : end.layout.pose[-1].stop]
    noise = larger.chi_square() / _freedom(larger, end)
    expected = _square(found, cameras[at, at])
    gained = min(1.0, gain / expected)
    by_noise = f_tail(gained * expected / (noise * more), more, _freedom(larger, end))
    if by_noise >= least:
        return by_noise
    by_print = np.zeros_like(cameras)
    views = ViewDispersion.of(larger, noise)
    if not entered.adjusted.layout.freedom.dots.shape[1]:
        share = PrintShare.of_declared(larger)
        by_print, noise = share.covariance, share.noise
    total = noise * max(1.0, views.ratio) * cameras + by_print
    return f_tail(gained * _square(found, total[at, at]) / more, more, 2.0 / max(views.sigma, 1e-6) ** 2)


def _stepped(entered: Entered, camera: Camera) -> tuple[Entered, ViewsEliminated, float] | None:
    """Return the adjustment after a step with another lens, its equations, and what the cost decreased.

    None where the step fails.
    """
    before = entered.adjusted
    state = replace(entered.state, cameras=(camera,))
    prior = LensPrior.of(state, entered.observations, Lenses.FREE, PriorWidth.WIDE)
    problem = AdjustmentProblem(entered.observations, before.layout.freedom, prior=prior)
    stepped = problem.linearize(state).stepped(_UNDAMPED)
    gain = -1.0 if stepped is None else problem.cost(state) - problem.cost(stepped)
    if stepped is None or not gain > 0.0:
        return None
    end = problem.linearize(stepped)
    after = replace(before, state=stepped, layout=end.layout, end=end, prior=prior)
    return Entered(after, entered.observations), end, gain


def _freedom(entered: Entered, end: ViewsEliminated) -> float:
    """Return the degrees of freedom of the residuals."""
    views = len(np.unique(entered.observations.view))
    return float(max(1, 2 * len(entered.observations) - end.layout.count - POSE * views))


def _square(found: Float64[np.ndarray, " n"], covariance: Float64[np.ndarray, "n n"]) -> float:
    """Return the sum of squares of numbers in units of their covariance."""
    return float(found @ np.linalg.solve(covariance, found))
