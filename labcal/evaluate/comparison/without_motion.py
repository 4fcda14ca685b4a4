"""Differences of two calibrations from which a motion that no measurement tells has been removed."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float64

from labcal.evaluate.comparison.weighted_squares import weighted_squares_tail


@dataclass(frozen=True)
class Uncertain:
    """The derivatives of differences by the parameters of a calibration, and these parameters' covariance."""

    by: Float64[np.ndarray, "n m parameters"]
    covariance: Float64[np.ndarray, "parameters parameters"]

    def blocks(self) -> Float64[np.ndarray, "n m m"]:
        """Return the covariance of the difference of each point."""
        return np.asarray(self.by @ self.covariance @ self.by.transpose(0, 2, 1))

    @cached_property
    def root(self) -> Float64[np.ndarray, "n m parameters"]:
        """Derivatives by standard normal deviates that make the parameters."""
        value, vector = np.linalg.eigh(self.covariance)
        return np.asarray(self.by @ (vector * np.sqrt(np.maximum(value, 0.0))))


@dataclass(frozen=True)
class MotionRemover:
    """A weighted least-squares fit of a motion to differences: what it takes away, and what it leaves.

    Attributes
    ----------
    design : float64 array, (n, m, motion)
        Derivatives of the difference of each point by the parameters of the motion.
    weight : float64 array, (n, m, m)
        Inverse covariances.
    fitted : bool array, (n,)
        The points that determine the motion.
    """

    design: Float64[np.ndarray, "n m motion"]
    weight: Float64[np.ndarray, "n m m"]
    fitted: Bool[np.ndarray, " n"]

    @cached_property
    def solver(self) -> Float64[np.ndarray, "motion coordinates"]:
        """The motion of differences, from those of the fitted points one after the other."""
        J, W = self.design[self.fitted], self.weight[self.fitted]
        WJ = W @ J
        normal = np.einsum("nmi,nmj->ij", J, WJ)
        scale = np.sqrt(np.maximum(np.diagonal(normal), np.finfo(np.float64).tiny))
        # Covariances that leave a direction open make the scaled matrix nearly singular, too.
        inverse = np.linalg.pinv(normal / scale[:, None] / scale, hermitian=True)
        return np.asarray((inverse / scale[:, None] / scale) @ WJ.reshape(-1, J.shape[2]).T)

    def motion(
        self, difference: Float64[np.ndarray, "n m *parameters"]
    ) -> Float64[np.ndarray, "motion *parameters"]:
        """Return the motion that explains differences best, or their derivatives."""
        flat = difference[self.fitted].reshape(self.solver.shape[1], *difference.shape[2:])
        return np.asarray(self.solver @ flat)

    def left(self, by: Float64[np.ndarray, "n m parameters"]) -> Float64[np.ndarray, "n m parameters"]:
        """Return derivatives of differences of which the motion has been removed."""
        return np.asarray(by - self.design @ self.motion(by))


@dataclass(frozen=True)
class RemainingDifference:
    """Differences after the motion, with the shares of both calibrations in what is to be expected.

    Attributes
    ----------
    difference : float64 array, (n, m)
        Second minus first: px or mm; NaN where one of them has no value.
    one, other : Uncertain or None
        Of a calibration that states its covariance.
    weight : float64 array, (n, m, m)
        Of the test.
    tested : bool array, (n,)
        Points that the test and the summary are of.
    """

    difference: Float64[np.ndarray, "n m"]
    one: Uncertain | None
    other: Uncertain | None
    weight: Float64[np.ndarray, "n m m"]
    tested: Bool[np.ndarray, " n"]

    @property
    def length(self) -> Float64[np.ndarray, " n"]:
        """The length of each difference."""
        return np.asarray(np.linalg.norm(self.difference, axis=1))

    @property
    def rms(self) -> float:
        """RMS length over the tested points."""
        return float(np.sqrt((self.length[self.tested] ** 2).mean()))

    @property
    def largest(self) -> float:
        """The largest length among the tested points."""
        return float(self.length[self.tested].max())

    def expected(self, of: Uncertain | None) -> Float64[np.ndarray, " n"]:
        """Return the expected length (RMS) of each difference by a calibration's errors; NaN if not known."""
        if of is None:
            return np.full(len(self.difference), np.nan)
        return np.asarray(np.sqrt(np.trace(of.blocks(), axis1=1, axis2=2)))

    def expected_rms(self, of: Uncertain | None) -> float:
        """Return the RMS of that over the tested points."""
        return float(np.sqrt((self.expected(of)[self.tested] ** 2).mean()))

    @property
    def expected_of_both(self) -> float:
        """Expected RMS difference of two independent calibrations; NaN where one states no covariance."""
        return float(np.hypot(self.expected_rms(self.one), self.expected_rms(self.other)))

    def p_value(self) -> float:
        """Return the chance of such differences, or larger ones, between independent calibrations.

        Returns
        -------
        float
            NaN where a calibration states no covariance.

        Notes
        -----
        The sum of weighted squares of differences is a quadratic form of normal errors of both calibrations;
        its distribution is a sum of squared deviates weighted by the eigenvalues of their covariance.
        """
        if self.one is None or self.other is None:
            return float("nan")
        W, d = self.weight[self.tested], self.difference[self.tested]
        value = float(np.einsum("ni,nij,nj->", d, W, d))
        root = np.concatenate([self.one.root[self.tested], self.other.root[self.tested]], axis=2)
        form = np.einsum("nip,nij,njq->pq", root, W, root, optimize=True)
        return weighted_squares_tail(value, np.maximum(np.linalg.eigvalsh(form), 0.0))
