"""The directions of plane waves in a residual field."""

import numpy as np

from labcal.estimators.gp_field.restricted import Logs, RestrictedLikelihood
from labcal.estimators.gp_field.waves import Spread

_APART = 1.0
"""Radians by which the phases of neighbouring directions differ at the picture's edge: a wave between two of
them is the sum of both."""
_REACH = 0.625
"""From the picture's middle to its corner, in widths of pictures of 4 to 3."""
_ROUNDS = 30
_NEGLIGIBLE = 1e-3
"""Share of the variance below which a direction has no wave."""


def spread_of_waves(likelihood: RestrictedLikelihood, logs: Logs) -> tuple[Spread, float]:
    """Return the likeliest shares of directions, and the field's variance over the noise's with them.

    Parameters
    ----------
    likelihood : RestrictedLikelihood
    logs : float64 array, (4,)
        Hyperparameters of waves in all directions, where the search begins.

    Notes
    -----
    The variances of waves are variance components. Each is multiplied by what it explains over what it takes
    up, which is 1 where the restricted likelihood is greatest (Harville 1977). Directions that explain
    nothing lose their variance by themselves, as in sparse Bayesian learning (Tipping 2001). A round may
    lower the likelihood, so that the caller compares both ends.
    """
    ratio, _, _, wavenumber = np.exp(logs).tolist()
    count = max(4, int(np.ceil(np.pi * wavenumber * _REACH / _APART)))
    directions = np.pi * np.arange(count) / count
    x = likelihood.x
    decay = likelihood.kernel(logs).decay(x, x)
    phase = wavenumber * x[:, :2] @ np.stack([np.cos(directions), np.sin(directions)])
    cosine, sine = np.cos(phase), np.sin(phase)
    variance = np.full(count, ratio / count)
    for _ in range(_ROUNDS):
        W = decay * ((cosine * variance) @ cosine.T + (sine * variance) @ sine.T)
        W[np.diag_indices_from(W)] += 1.0
        parts = likelihood.derivatives(W)
        takes, explains = (
            ((one @ cosine) * cosine).sum(axis=0) + ((one @ sine) * sine).sum(axis=0)
            for one in (2.0 * parts.half_projector * decay, parts.explained * decay)
        )
        variance = variance * np.maximum(explains, 0.0) / takes
    kept = variance > _NEGLIGIBLE * variance.sum()
    total = float(variance[kept].sum())
    return Spread(tuple(directions[kept].tolist()), tuple((variance[kept] / total).tolist())), total
