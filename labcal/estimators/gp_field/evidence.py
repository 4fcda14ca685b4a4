"""Hyperparameters of a residual field by restricted maximum likelihood."""

from dataclasses import dataclass, replace
from itertools import product

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.estimators.gp_field.kernel import FieldKernel
from labcal.estimators.gp_field.restricted import NO_FIELD, Logs, RestrictedLikelihood
from labcal.estimators.gp_field.wave_directions import spread_of_waves
from labcal.estimators.gp_field.waves import ALL_ALIKE
from labcal.rng import generator

_RATIOS, _ACROSS, _ALONG = (1.0, 1e2, 1e4, 1e6), (0.06, 0.12, 0.25, 0.5), (0.6, 2.0, 8.0)
"""Of all of these together, the search begins at the likeliest."""
_WAVENUMBERS, _TRAINS = tuple(2.0 * np.pi * np.arange(1.5, 10.5, 0.4)), (0.4, 2.0)
"""Of waves, and the lengths over which their trains decay: the search begins at the likeliest place of each
train. Trains across all of the picture tell wavenumbers apart that differ by half a turn over it."""
_LOUD = (1e2, 1e4)
"""Ratios of variances of waves; one of a field without waves is none of theirs, if that has missed them."""
_GLANCED = 300
"""Points, drawn from all, that tell where the search for waves begins."""
_WORTH = 6.0
"""Gain of the logarithm of the likelihood from which on a field is there: by chance, three numbers more gain
this once in some hundred cases (Wilks 1938: half a chi-square)."""


_NOISE_ROUNDS = 5
"""Of the noise beside errors of a stage: each is a fixed-point step, and converges within a percent."""


@dataclass(frozen=True)
class FieldScale:
    """The hyperparameters of a field.

    Attributes
    ----------
    kernel : FieldKernel
    amplitude_px : float
        Standard deviation of each coordinate of the field; 0 where there is none.
    noise_px : float
        Standard deviation of each coordinate of a measurement.
    gain : float
        How much more likely the residuals are with the field than without, in natural logarithms.
    """

    kernel: FieldKernel
    amplitude_px: float
    noise_px: float
    gain: float

    def root(self, x: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n n"]:
        """Return the lower Cholesky factor of the covariance of measurements at places, px."""
        V = self.amplitude_px**2 * self.kernel.between(x, x)
        V[np.diag_indices_from(V)] += self.noise_px**2
        return np.asarray(scipy.linalg.cholesky(V, lower=True, overwrite_a=True, check_finite=False))


@dataclass(frozen=True)
class LikelyScale:
    """The likeliest hyperparameters of a field.

    Attributes
    ----------
    scale : FieldScale
    likelihood : float
        The restricted log-likelihood but for a constant, in natural logarithms: of the same pixels it can be
        compared between cameras.
    waves : FieldScale, optional
        Of a field of waves that is as likely as one without, which `scale` is: the residuals do not decide.
    """

    scale: FieldScale
    likelihood: float
    waves: FieldScale | None = None


def field_scale(
    x: Float64[np.ndarray, "n 3"],
    residual: Float64[np.ndarray, "n 2"],
    by_camera: Float64[np.ndarray, "n 2 free"],
    near: FieldScale | None = None,
    by_stage: Float64[np.ndarray, "n 2 effects"] | None = None,
) -> LikelyScale:
    """Return the best field of residuals while the parameters of the camera are free.

    Parameters
    ----------
    x : ndarray, shape (n, 3)
        Two coordinates of the picture and one of depth, each with a training range of about 1.
    residual : ndarray, shape (n, 2)
        Measured minus predicted by the camera, px.
    by_camera : ndarray, shape (n, 2, free)
        Derivatives of the prediction; those by what no pixel depends on, as the depth of a camera with
        parallel rays, are 0 and count for nothing.
    near : FieldScale, optional
        Where to begin.
    by_stage : ndarray, shape (n, 2, effects), optional
        What errors of a stage do to the residuals, px by their standard deviations: these are no field.

    Notes
    -----
    The likelihood is restricted to what the camera's parameters cannot take up (Patterson and Thompson
    1971), so that the field is neither starved by a camera that has absorbed it nor asked to explain what
    the camera can. The noise's variance follows in closed form.
    """
    seen = (by_camera != 0.0).any(axis=(0, 1))
    likelihood = RestrictedLikelihood(
        x, residual, by_camera if seen.all() else np.ascontiguousarray(by_camera[..., seen])
    )
    if by_stage is not None:
        noise_px = None if near is None else near.noise_px
        likelihood = _with_stage(likelihood, by_stage, noise_px)
    no_field = likelihood.cost(NO_FIELD)
    rival = None
    if near is not None and near.amplitude_px > 0.0:
        if near.kernel.waves is not None and near.kernel.waves.spread != ALL_ALIKE:
            likelihood, best = _with_directions(likelihood, _logs(near))
        else:
            best = likelihood.best_from(_logs(near))
    else:
        start = min((np.log(place) for place in product(_RATIOS, _ACROSS, _ALONG)), key=likelihood.cost)
        best = likelihood.best_from(start)
        if no_field - likelihood.cost(best) >= _WORTH:
            best, rival = _with_waves(likelihood, best)
    if no_field - likelihood.cost(best) < _WORTH:
        none = FieldScale(likelihood.kernel(NO_FIELD), 0.0, likelihood.noise(NO_FIELD), 0.0)
        return LikelyScale(none, -no_field)
    if likelihood.spread == ALL_ALIKE:
        likelihood, best = _directed(likelihood, best)
    return LikelyScale(
        _scale(likelihood, best, no_field),
        -likelihood.cost(best),
        None if rival is None else _scale(likelihood, rival, no_field),
    )


def _with_stage(
    likelihood: RestrictedLikelihood, by_stage: np.ndarray, noise_px: float | None
) -> RestrictedLikelihood:
    """Return the likelihood with errors of a stage; unknown noise is that without a field."""
    if noise_px is not None:
        return replace(likelihood, by_stage=by_stage, noise_px=noise_px)
    noise_px = likelihood.noise(NO_FIELD)
    for _ in range(_NOISE_ROUNDS):
        likelihood = replace(likelihood, by_stage=by_stage, noise_px=noise_px)
        noise_px = likelihood.noise(NO_FIELD)
    return likelihood


def _scale(likelihood: RestrictedLikelihood, logs: Logs, no_field: float) -> FieldScale:
    """Return the scale of hyperparameters; `no_field` is the cost without a field."""
    noise = likelihood.noise(logs)
    amplitude = float(np.exp(0.5 * logs[0])) * noise
    return FieldScale(likelihood.kernel(logs), amplitude, noise, no_field - likelihood.cost(logs))


def _logs(scale: FieldScale) -> Logs:
    """Return the logarithms of a field's hyperparameters."""
    kernel, ratio = scale.kernel, (scale.amplitude_px / scale.noise_px) ** 2
    waves = [] if kernel.waves is None else [kernel.waves.wavenumber]
    return np.log([ratio, kernel.across, kernel.along, *waves])


def _directed(likelihood: RestrictedLikelihood, best: Logs) -> tuple[RestrictedLikelihood, Logs]:
    """Return the likelihood and the hyperparameters with waves of some directions, where that is worth it.

    Each direction that is kept costs half the logarithm of the number of measurements (Schwarz 1978).
    """
    if likelihood.kernel(best).waves is None:
        return likelihood, best
    directed, found = _with_directions(likelihood, best)
    worth = 0.5 * len(directed.spread.directions) * np.log(likelihood.residual.size)
    if likelihood.cost(best) - directed.cost(found) < worth:
        return likelihood, best
    return directed, found


def _with_directions(likelihood: RestrictedLikelihood, near: Logs) -> tuple[RestrictedLikelihood, Logs]:
    """Return the likelihood with waves of some directions, and its hyperparameters near those of waves."""
    spread, ratio = spread_of_waves(_thinned(likelihood), near)
    directed = likelihood.with_spread(spread)
    return directed, directed.best_from(np.array([np.log(ratio), *near[1:]]))


def _with_waves(likelihood: RestrictedLikelihood, without: Logs) -> tuple[Logs, Logs | None]:
    """Return the hyperparameters of waves if they are likelier than those without.

    Else those without, and besides them those of waves that are as likely.
    """
    along = float(np.exp(without[2]))
    glance = _thinned(likelihood)
    ends = []
    for train in _TRAINS:
        starts = (np.log(place) for place in product(_LOUD, (train,), (along,), _WAVENUMBERS))
        ends.append(likelihood.best_from(min(starts, key=glance.cost)))
    waves = min(ends, key=likelihood.cost)
    gain = likelihood.cost(without) - likelihood.cost(waves)
    if gain >= _WORTH:
        return waves, None
    return without, waves if gain > -_WORTH else None


def _thinned(likelihood: RestrictedLikelihood) -> RestrictedLikelihood:
    """Return that of some of the points."""
    n = len(likelihood.x)
    if n <= _GLANCED:
        return likelihood
    some = np.sort(generator(0, "waves of a field").permutation(n)[:_GLANCED])
    return replace(
        likelihood,
        x=likelihood.x[some],
        residual=likelihood.residual[some],
        by_camera=likelihood.by_camera[some],
        by_stage=None if likelihood.by_stage is None else likelihood.by_stage[some],
    )
