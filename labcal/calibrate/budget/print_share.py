"""The print's share of a calibration's errors: all views see the same dots, off by the same amounts.

More views do not average it away, and no residual shows all of it: a print that is too large as a whole is a
rig that is too large.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.dot_freedom import plane_modes
from labcal.calibrate.adjustment.problem import ViewsEliminated
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.budget.entered import Entered
from labcal.calibrate.budget.known_errors import KnownErrors
from labcal.calibrate.freed_dots import FreedDots
from labcal.targets.places import DotPlaces

_HELD = 0.5
"""Between the eigenvalues of directions that are held, 1, and of those that are free, 0."""
_MOTIONS = 3
"""The first of the modes of the plane: two shifts and a rotation."""
_LEAST_NOISE = 0.25
"""Share of the squares of residuals that is noise at least, whatever errors of the print are known."""
_MOST_DOTS = 400
"""Dots whose errors are followed one by one; of larger boards, so many stand for all."""


@dataclass(frozen=True)
class PrintShare:
    """Errors of dots on the print, independent and alike in both directions of the plane.

    Attributes
    ----------
    sigma_mm : float
        Standard deviation of a dot along each direction of the plane, mm; 0 where residuals show none.
    residual : float
        Variance of residuals over the one that their covariances state.
    noise : float
        The same without the print's share.
    unevenness : float
        Standard normal deviate of the score test of dots that are where they are declared; 0 where freed.
    effect : float64 array, (cameras, modes)
        Derivatives of the cameras' parameters by errors of the print that the adjustment did not free.
    """

    sigma_mm: float
    residual: float
    noise: float
    unevenness: float
    effect: Float64[np.ndarray, "cameras modes"]
    datum: Float64[np.ndarray, "coordinates open"]
    """Errors of the places of dots that no view tells, where these were freed, one sigma each, mm."""
    measured: Float64[np.ndarray, "cameras cameras"]
    """The share of errors that a print's measurement had, where its dots were given."""
    measured_sigma_mm: float = 0.0
    """Standard deviation along each direction of the plane that they were measured with."""

    @property
    def covariance(self) -> Float64[np.ndarray, "cameras cameras"]:
        """The share of the print in the covariance of the cameras."""
        return np.asarray(self.sigma_mm**2 * self.effect @ self.effect.T + self.measured)

    @classmethod
    def of_declared(cls, entered: Entered, known: DotPlaces | None = None) -> "PrintShare":
        """Return the share where dots were taken as declared; residuals tell the size of their errors.

        Parameters
        ----------
        entered : Entered
        known : DotPlaces or None
            The places, where they were measured before: with errors that are known, beside those that
            residuals tell.

        Notes
        -----
        With B the information about errors of dots after all else has followed, the gradient g by them has
        the expected square tr(B) times the noise plus tr(B B) times the print's variance; the sum of squares
        of residuals their degrees of freedom times the noise plus tr(B) times the print's variance. The two
        equations give both variances (variance components by moments, as Paule and Mandel 1982 for one). What
        known errors contribute is subtracted first.
        """
        measured = np.flatnonzero(np.bincount(entered.observations.dot, minlength=len(entered.state.dots)))
        some = measured[:: -(-len(measured) // _MOST_DOTS)]
        stand_for = len(measured) / len(some)
        errors = KnownErrors.of(known, some, len(entered.state.dots))
        end = entered.linearised(np.concatenate([errors.directions, errors.common], axis=1))
        free, single = entered.cameras, len(errors.own)
        information, gradient = reduced_information(end)
        C = entered.with_fixed_dots().shared_spread()
        across = information[:free, free:]
        information = information[free:, free:] - across.T @ C @ across
        all_of_some, flat = information[:single, :single], errors.in_plane
        B = all_of_some[np.ix_(flat, flat)]
        trace, square = float(np.trace(B)), float((B * B).sum())
        total, freedom = entered.chi_square(), _freedom(entered, free)
        found = float((gradient[free : free + single][flat] ** 2).sum())
        known_total = stand_for * float((all_of_some * errors.own).sum())
        known_total += float(np.trace(information[single:, single:]))
        seen = all_of_some[flat]
        known_found = float(
            ((seen @ errors.own) * seen).sum() + (information[:single, single:][flat] ** 2).sum()
        )
        residual = total / freedom
        plain = max(total - known_total, _LEAST_NOISE * total) / freedom
        variance = (found - known_found - plain * trace) / max(
            square - stand_for * trace**2 / freedom, 1e-300
        )
        noise = plain - max(0.0, variance) * stand_for * trace / freedom
        if not (variance > 0.0 and noise > 0.0):
            variance, noise = 0.0, plain
        unevenness = (found - known_found - plain * trace) / max(plain * float(np.sqrt(2.0 * square)), 1e-300)
        by_single, by_common = np.sqrt(stand_for) * C @ across[:, :single], C @ across[:, single:]
        return cls(
            float(np.sqrt(variance)),
            residual,
            noise,
            unevenness,
            by_single[:, flat],
            datum=np.zeros((entered.state.dots.size, 0)),
            measured=by_single @ errors.own @ by_single.T + by_common @ by_common.T,
            measured_sigma_mm=errors.sigma_mm,
        )

    @classmethod
    def of_freed(cls, entered: Entered, dots: FreedDots) -> "PrintShare":
        """Return the share where dots were freed: what no view tells, above all the size of the whole.

        The found displacements tell how far dots are off; their mean scale, and what was constrained, is as
        declared and off by what dots that are off so much are off in the mean.
        """
        basis = entered.adjusted.layout.freedom.dots
        modes = plane_modes(entered.state.dots, dots.freed)
        spread, axes = np.linalg.eigh(modes.T @ modes - modes.T @ basis @ (basis.T @ modes))
        held = modes @ axes[:, spread > _HELD]
        end = entered.linearised(np.concatenate([basis, held], axis=1))
        known = entered.cameras + basis.shape[1]
        information, _ = reduced_information(end)
        C = entered.linearised(basis).shared_spread()
        effect = C[: entered.cameras] @ information[:known, known:]
        in_plane = (dots.displacement[dots.freed, :2] ** 2).sum()
        noise_of_it = (dots.sigma[dots.freed, :2] ** 2).sum()
        free = max(1, 2 * int(dots.freed.sum()) - held.shape[1])
        variance = max(0.0, float(in_plane - noise_of_it)) / free
        noise = entered.chi_square() / _freedom(entered, known)
        sigma = float(np.sqrt(variance))
        # Shift and rotation of the whole are the pose's, whatever a view tells.
        moved = modes[:, :_MOTIONS]
        open_parts, size, _ = np.linalg.svd(held - moved @ (moved.T @ held), full_matrices=False)
        datum = sigma * open_parts[:, size > _HELD]
        nothing = np.zeros((entered.cameras, entered.cameras))
        return cls(sigma, noise, noise, 0.0, effect, datum=datum, measured=nothing)


def reduced_information(end: ViewsEliminated) -> tuple[Float64[np.ndarray, "n n"], Float64[np.ndarray, " n"]]:
    """Return information and gradient of all that views share, after their poses have followed."""
    reduced = end.reduced
    if reduced is None:
        n = len(end.blocks.shared)
        return np.zeros((n, n)), np.zeros(n)
    scale = reduced.scale
    return reduced.matrix * np.outer(scale, scale), reduced.gradient(end.blocks.gradient) * scale


def _freedom(entered: Entered, shared: int) -> float:
    """Return the degrees of freedom of the residuals, where so many parameters are shared by all views."""
    views = len(np.unique(entered.observations.view))
    return float(max(1, 2 * len(entered.observations) - shared - POSE * views))
