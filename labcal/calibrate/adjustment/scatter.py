"""Variance component: the variance of dots in addition to their stated covariances."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64
from scipy.optimize import brentq

_MEDIAN = 2.0 * np.log(2.0)
"""Of a chi-square of two components."""


@dataclass(frozen=True)
class Scatter:
    """Residuals and the covariances that they should have, along the covariances' axes."""

    square: Float64[np.ndarray, "n 2"]
    """Squared residuals, px squared."""
    spread: Float64[np.ndarray, "n 2"]
    """Variances, px squared."""
    share: float
    """Degrees of freedom over the number of residuals' components."""

    @classmethod
    def of(
        cls, residual: Float64[np.ndarray, "n 2"], covariance: Float64[np.ndarray, "n 2 2"], share: float
    ) -> "Scatter":
        """Return the scatter of residuals (px) whose pixels alone have covariances (px squared)."""
        spread, axes = np.linalg.eigh(covariance)
        return cls(np.einsum("nji,nj->ni", axes, residual) ** 2, spread, share)

    def squares(self, extra: float) -> Float64[np.ndarray, " n"]:
        """Return squared residuals over their variances with some (px squared) added."""
        return np.asarray((self.square / (self.spread + extra)).sum(axis=1))

    def extra_variance(self) -> float:
        """Return the additional variance (px squared) for which residuals agree with their covariances.

        What a model does not know (a print that is off, a lens of another kind) makes residuals that do not
        shrink with a dot's own noise. Weights that ignore this trust the sharpest dots too much, and stated
        uncertainties are too small. 0 where the residuals are no larger than stated.

        Notes
        -----
        Solves sum r' (C + s I)^-1 r = expected for s, as in random-effects models (Paule and Mandel 1982).
        """
        expected = self.share * self.square.size
        return self._root(lambda extra: float(self.squares(extra).sum()) - expected)

    def robust_extra_variance(self) -> float:
        """Return the same by the median, on which a few gross outliers have no influence."""
        expected = self.share * _MEDIAN
        return self._root(lambda extra: float(np.median(self.squares(extra))) - expected)

    def _root(self, excess: Callable[[float], float]) -> float:
        """Return where a falling function of the extra variance vanishes."""
        if len(self.square) == 0 or excess(0.0) <= 0.0:
            return 0.0
        top = 2.0 * float(np.sqrt(self.square.sum() / self.share))
        root: float = brentq(lambda root: excess(root * root), 0.0, top, xtol=1e-11 * top)
        return root**2
