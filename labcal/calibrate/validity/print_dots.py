"""Dots of new views that lie elsewhere on the print than the target has them, in all pictures alike."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.state import POSE, RigState
from labcal.calibrate.validity.evidence import NewViews
from labcal.calibrate.validity.tested import Tested
from labcal.distributions import chi2_quantile, f_tail

CHANCE = 1e-3
"""Probability below which chance, and the calibration's print, are no explanation."""
_ABSORBED = 8
"""Degrees of freedom of dots that poses and cameras take up: those of a homography."""
_FEWEST = 3
"""Pictures that a dot must be in."""
_MOST_NAMED = 3
_STEP_MM = 1e-3


@dataclass(frozen=True)
class DisplacedDots:
    """Dots that lie elsewhere on the print than expected.

    Attributes
    ----------
    rms_mm : float
        RMS distance in the plane from the places that the calibration's target has, without what noise adds.
    expected_mm : float
        The same of the print of the calibration, by its own residuals.
    p_value : float
        Probability that noise and a print as even as that show so much.
    named : tuple of (int, int)
        Numbers in the order of the target's indices, and distances in mm, of single dots that are off by
        themselves, the farthest first; at most three.
    """

    rms_mm: float
    expected_mm: float
    p_value: float
    named: tuple[tuple[int, float], ...]


def displaced_dots(found: Tested) -> DisplacedDots | None:
    """Return the dots that are displaced on the print; None where they are as expected, and of fixed marks.

    Parameters
    ----------
    found : Tested

    Notes
    -----
    About the best explanation by cameras, of which any may have changed, each dot has a step of Gauss and
    Newton in the plane of the board from all its pictures. The noise of residuals after it is found by their
    median, so that single wrong pictures of dots do not hide the rest; with the views' disagreement it is
    the denominator of an F statistic over all dots. A dot is named where its own share is beyond chance for
    the largest of so many, and most of its pictures show the displacement.
    """
    made = found.made
    seen = made.with_outliers
    if seen is None or not isinstance(made.views, NewViews):
        return None
    state = found.changed[-1].evidence.state
    steps = _Steps.of(state, seen)
    many = np.bincount(steps.dot, minlength=len(state.dots)) >= _FEWEST
    rows = many[steps.dot]
    left = 2 * int(rows.sum()) - 2 * int(many.sum()) - POSE * made.poses
    if many.sum() <= _ABSORBED or left <= 0:
        return None
    noise = steps.noise(rows, left) * max(1.0, made.view_factor)
    expected = made.views.print_sigma_mm
    spread = noise * steps.spread[many] + expected**2 * np.eye(2)
    moved = steps.moved[many]
    square = np.einsum("ki,kij,kj->k", moved, np.linalg.inv(spread), moved)
    count = 2 * len(moved)
    p_value = f_tail(float(square.sum()) / (count - _ABSORBED), count - _ABSORBED, float(left))
    single = [f_tail(0.5 * one, 2, float(left)) * len(moved) for one in square.tolist()]
    numbers = np.flatnonzero(many)
    alone = [k for k, p in enumerate(single) if p < CHANCE and steps.agree(int(numbers[k]), moved[k])]
    alone.sort(key=lambda k: -float(np.linalg.norm(moved[k])))
    if p_value >= CHANCE and not alone:
        return None
    by_noise = noise * np.trace(steps.spread[many], axis1=1, axis2=2)
    rms = float(np.sqrt(max(0.0, float(((moved**2).sum(axis=1) - by_noise).mean()))))
    named = tuple((int(numbers[k]), float(np.linalg.norm(moved[k]))) for k in alone[:_MOST_NAMED])
    return DisplacedDots(rms, expected * float(np.sqrt(2.0)), min([p_value, *single, 1.0]), named)


@dataclass(frozen=True)
class _Steps:
    """Displacements of dots in the plane of the board, from their residuals."""

    dot: Int64[np.ndarray, " n"]
    residual: Float64[np.ndarray, "n 2"]
    """Whitened."""
    columns: Float64[np.ndarray, "n 2 2"]
    """Whitened derivatives by the dot's place, 1/mm."""
    spread: Float64[np.ndarray, "dots 2 2"]
    """Covariances of the displacements by the stated noise, mm squared."""
    moved: Float64[np.ndarray, "dots 2"]
    """Mm."""

    @classmethod
    def of(cls, state: RigState, seen: Observations) -> "_Steps":
        """Return those of a state."""
        residual, columns = state.residuals(seen), []
        for axis in range(2):
            there = replace(state, dots=state.dots + _STEP_MM * np.eye(3)[axis])
            columns.append((there.residuals(seen) - residual) / _STEP_MM)
        imaged = np.isfinite(np.column_stack([residual, *columns])).all(axis=1)
        seen, residual = seen.where(imaged), residual[imaged]
        white = seen.whitener
        r = white.whiten(residual.T).T
        J = np.stack([white.whiten(one[imaged].T).T for one in columns], axis=2)
        count = len(state.dots)
        H, g = np.zeros((count, 2, 2)), np.zeros((count, 2))
        np.add.at(H, seen.dot, np.einsum("nai,naj->nij", J, J))
        np.add.at(g, seen.dot, np.einsum("nai,na->ni", J, r))
        measured = np.bincount(seen.dot, minlength=count) > 0
        spread, moved = np.full((count, 2, 2), np.nan), np.full((count, 2), np.nan)
        spread[measured] = np.linalg.inv(H[measured])
        moved[measured] = -np.einsum("kij,kj->ki", spread[measured], g[measured])
        return cls(seen.dot, r, J, spread, moved)

    def noise(self, rows: np.ndarray, left: int) -> float:
        """Return the variance of what displacements leave, over the stated one."""
        rest = self.residual[rows] + np.einsum("nai,ni->na", self.columns[rows], self.moved[self.dot[rows]])
        share = left / (2 * int(rows.sum()))
        return float(np.median((rest**2).sum(axis=1))) / (chi2_quantile(0.5, 2) * share)

    def agree(self, dot: int, moved: Float64[np.ndarray, " 2"]) -> bool:
        """Tell whether most pictures of a dot show at least half of its displacement."""
        rows = self.dot == dot
        along = np.einsum("nai,i->na", self.columns[rows], moved)
        share = -(self.residual[rows] * along).sum(axis=1) / (along**2).sum(axis=1)
        return float((share > 0.5).mean()) > 0.7  # noqa: PLR2004 -- as said
