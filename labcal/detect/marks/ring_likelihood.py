"""Likelihood of what is seen around a dot, if its ring is in sight at an angle and if something hides it."""

import numpy as np
from jaxtyping import Float64

from labcal.detect.marks.ring_samples import RingSamples

_WIDTH = 2.2
"""Width of the range of grey values of which any is as likely of a cover, in steps from paper to dot."""
_SEEN = (0.9, 0.04, 0.04, 0.02)
"""Probability, where the ring is in sight, that paper is in sight on both of its sides, not within it, not
beyond it, and on neither side."""
_HIDDEN = (0.05, 0.25, 0.25, 0.45)
"""The same where the ring is hidden."""
_ALIKE = 0.6
"""Probability that the ring is then as grey as what hides paper beside it."""


def ring_likelihoods(
    samples: RingSamples,
    printed: tuple[np.ndarray, np.ndarray, np.ndarray],
    sigma: float,
) -> tuple[Float64[np.ndarray, "words angles"], Float64[np.ndarray, "words angles"]]:
    """Return log-likelihoods of all words at all angles, of a ring in sight and of a hidden one.

    Of a ring in sight grey values are normal about those of the word as blur shows it. A cover has any grey
    value, and mostly the same on the ring as beside it; and what hides the ring mostly hides paper beside
    it. Beyond the frame nothing is seen, and the ring counts as hidden.

    Parameters
    ----------
    samples : RingSamples
    printed : tuple of three ndarray, shape (words, angles)
        Grey values of gap, ring and paper, by each word.
    sigma : float
        Standard deviation of grey values.
    """
    known = np.isfinite(samples.gap) & np.isfinite(samples.ring) & np.isfinite(samples.paper)
    g, r, p = (np.where(known, part, 0.0) for part in (samples.gap, samples.ring, samples.paper))
    any_ = 1.0 / _WIDTH
    gap, paper = _normal(g - printed[0], sigma), _normal(p - printed[2], sigma)
    both, beyond, within, neither = gap * paper, gap * any_, any_ * paper, any_**2
    # Where the gap is not in sight, paper beyond the ring is: `within` is what hides the gap.
    beside = _SEEN[0] * both + _SEEN[1] * within + _SEEN[2] * beyond + _SEEN[3] * neither
    off = (r - printed[1]) / sigma
    seen = np.log(beside) - 0.5 * off**2 - np.log(sigma * np.sqrt(2.0 * np.pi))
    by_gap, by_paper = ((1.0 - _ALIKE) * any_ + _ALIKE * _normal(r - part, sigma) for part in (g, p))
    covered = (
        _HIDDEN[0] * both * any_
        + _HIDDEN[1] * within * by_gap
        + _HIDDEN[2] * beyond * by_paper
        + _HIDDEN[3] * neither * 0.5 * (by_gap + by_paper)
    )
    return np.where(known, seen, -np.inf), np.where(known, np.log(covered), 0.0)


def _normal(off: np.ndarray, sigma: float) -> np.ndarray:
    """Return the density of a normal distribution."""
    return np.asarray(np.exp(-0.5 * (off / sigma) ** 2) / (sigma * np.sqrt(2.0 * np.pi)))
