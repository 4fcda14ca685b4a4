"""Dispersion of views: whether they disagree about the cameras by more than the noise of their dots.

Residuals of one view share that view's errors: a lens model that is too simple, a board that bends in the
hand, motion. A covariance from independent pixels is then too small. Each view's score (the gradient of its
part of the cost by the cameras, after its own pose has followed) tells in which direction it would pull them.
"""

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.blocks import assemble
from labcal.calibrate.adjustment.datum_constraints import DatumConstraints
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.budget.entered import Entered
from labcal.optim.robust import SQUARES

ViewScore = tuple[Float64[np.ndarray, " shared"], Float64[np.ndarray, "shared shared"]]
"""Gradient of a view's part of the cost by the cameras, and its information about them."""
_CHANCE = 3.0
"""Standard deviations of the ratio."""


@dataclass(frozen=True)
class ViewDispersion:
    """The mean square of the views' scores over what the covariances of their dots predict.

    Attributes
    ----------
    ratio : float
        1 where views disagree by the noise of their dots alone.
    sigma : float
        Standard deviation of the ratio by chance, where they do.
    """

    ratio: float
    sigma: float

    @property
    def factor(self) -> float:
        """The factor of the covariance of the cameras: the ratio less its chance deviation, at least 1."""
        return max(1.0, self.ratio - self.sigma)

    @property
    def is_beyond_chance(self) -> bool:
        """True if views disagree by more than chance explains but once in a thousand good sets."""
        return self.ratio > 1.0 + _CHANCE * self.sigma

    @classmethod
    def of(cls, entered: Entered, residual: float) -> "ViewDispersion":
        """Return the dispersion of the views of an adjustment with free lenses.

        Parameters
        ----------
        entered : Entered
        residual : float
            Variance of residuals over the one that their covariances state.

        Notes
        -----
        With the covariance C of the cameras, the score s of a view and its share A of the information, the
        expected value of s' C s is tr(C A) - tr(C A C A): each view is followed by its leverage C A.
        By chance the sum varies by 2 sum tr((C S_vw) (C S_wv)) over all pairs of views, with the covariance
        S_vw of their scores: A_v - A_v C A_v of one, -A_v C A_w of two.

        The same scores as a matrix are the sandwich covariance clustered by view (Liang and Zeger 1986). With
        some ten views and twenty parameters that matrix has no full rank, while its trace is known to a few
        tenths (docs/decisions, 2026-11-26).
        """
        C = entered.with_fixed_dots().shared_spread()
        scores = view_scores(entered.state, entered.observations, entered.adjusted.layout.freedom.lenses)
        return cls.of_scores(C, scores, residual)

    @classmethod
    def of_scores(
        cls, C: Float64[np.ndarray, "shared shared"], views: "list[ViewScore]", residual: float
    ) -> "ViewDispersion":
        """Return the dispersion of the scores of views; `C` is the covariance that these views leave."""
        expected, found, chance = 0.0, 0.0, 0.0
        squares = np.zeros_like(C)
        for score, information in views:
            leverage = C @ information
            square = leverage @ leverage
            left = leverage - square
            found += float(score @ C @ score)
            expected += float(np.trace(left))
            chance += float((left * left.T).sum() - (square * square.T).sum())
            squares += square
        variance = 2.0 * (chance + float((squares * squares.T).sum()))
        if not expected > 0.0 or not residual > 0.0:
            return cls(1.0, 0.0)
        return cls(found / (residual * expected), float(np.sqrt(max(0.0, variance))) / expected)


def view_scores(start: RigState, observations: Observations, lenses: Lenses) -> list[ViewScore]:
    """Return the score of each view and its information about the cameras, its own pose eliminated."""
    seen = observations.view
    order = np.argsort(seen, kind="stable")
    edges = np.searchsorted(seen[order], np.arange(len(start.T_world_target) + 1))
    still = Freedom(lenses, np.zeros((start.dots.size, 0)))
    found = []
    for view, (first, end) in enumerate(pairwise(edges.tolist())):
        if first == end:
            continue
        # In their order, so that a camera's pictures stay together.
        state, rows = _of_view(start, observations, view, np.sort(order[first:end]))
        layout = Layout(state, still)
        blocks = DatumConstraints.of(layout, rows).applied(assemble(layout, rows, SQUARES))
        reach = np.linalg.solve(blocks.view[0], blocks.cross[0].T)
        score = blocks.gradient.shared - reach.T @ blocks.gradient.view[0]
        found.append((score, blocks.shared - blocks.cross[0] @ reach))
    return found


def _of_view(
    state: RigState, observations: Observations, view: int, rows: np.ndarray
) -> tuple[RigState, Observations]:
    """Return the state and the observations of one view alone, whose observations are `rows`."""
    seen = observations.where(rows)
    seen = replace(seen, view=np.zeros_like(seen.view))
    return replace(state, T_world_target=state.T_world_target[view : view + 1]), seen
