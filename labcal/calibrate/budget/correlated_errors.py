"""Errors that dots of a view share: their size from the residuals, and their share in the covariance."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.error_patterns import BOARD, SMOOTH, WHOLE, ErrorPatterns
from labcal.calibrate.budget.variance_components import VarianceComponents

_MOST_PATTERNS = 1600
"""From which variances are found; of more views, some that are spread evenly stand for all."""
_FEWEST_VIEWS = 3


@dataclass(frozen=True)
class CorrelatedErrors:
    """Errors of dots that are not independent within a view, but from view to view.

    Attributes
    ----------
    components : VarianceComponents
    covariance : float64 array, (cameras, cameras)
        Their share in the covariance of the cameras.
    """

    components: VarianceComponents
    covariance: Float64[np.ndarray, "cameras cameras"]

    @property
    def white(self) -> float:
        """Variance of independent errors over the stated one, one standard error wide."""
        return self.components.white + self.components.white_sigma

    @property
    def smooth_px(self) -> float:
        """Standard deviation of errors that are smooth over a picture, along each axis, px."""
        return float(np.sqrt(self.components.variance[SMOOTH]))

    @property
    def board_mm(self) -> float:
        """Standard deviation of errors that are smooth over the board, and that all cameras see, mm."""
        return float(np.sqrt(self.components.variance[BOARD]))

    @property
    def whole_px(self) -> float:
        """Standard deviation of shifts of whole pictures along each axis, px."""
        return float(np.sqrt(self.components.variance[WHOLE]))

    @classmethod
    def of(cls, entered: Entered) -> "CorrelatedErrors":
        """Return the errors that the residuals of an adjustment with free lenses show.

        Notes
        -----
        The parameters are those of the adjustment, which takes errors for independent: with the inverse C of
        its normal equations, patterns F and derivatives A, errors of variance s move them by C A' F, and add
        s C A' F F' A C to the covariance (the middle of a sandwich by a model in place of the few views'
        own scores). Each variance enters with one standard error more: few views tell it to a half, and what
        is divided by a variance that came out too small is far off.
        """
        end = entered.linearised(entered.adjusted.layout.freedom.dots)
        C = end.shared_spread()
        measured = np.unique(entered.observations.dot)
        patterns = ErrorPatterns.of(entered.state.dots, measured, len(entered.state.cameras))
        views = list(patterns.sums(end, entered.observations))
        kinds = patterns.kinds
        some = views[:: max(1, -(-len(views) // max(_FEWEST_VIEWS, _MOST_PATTERNS // len(kinds))))]
        share = len(some) / len(views)
        residuals = entered.chi_square() * share, _freedom(entered, C, len(views)) * share
        components = VarianceComponents.of(some, kinds, C, residuals)
        size = np.sqrt(components.variance + components.sigma)[kinds]
        moved = np.concatenate([C[: entered.cameras] @ (view.shared * size) for view in views], axis=1)
        return cls(components, moved @ moved.T)


def _freedom(entered: Entered, C: Float64[np.ndarray, "shared shared"], views: int) -> float:
    """Return the degrees of freedom of the residuals; the prior of lenses leaves more of them."""
    by_prior = float(np.diagonal(C)[: entered.cameras] @ entered.prior_by_parameter())
    return max(1.0, 2.0 * len(entered.observations) - POSE * views - (len(C) - by_prior))
