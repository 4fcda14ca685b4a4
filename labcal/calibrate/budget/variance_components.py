"""Variance components of the residuals of an adjustment, with allowance for what the fit has absorbed."""

from dataclasses import dataclass

import numpy as np
import scipy.optimize
from jaxtyping import Float64, Int64

from labcal.calibrate.budget.error_patterns import ViewSums


@dataclass(frozen=True)
class VarianceComponents:
    """Variances of independent errors of dots, and of patterns by their kind.

    Attributes
    ----------
    white : float
        Variance of independent errors, over the stated one.
    white_sigma : float
        Standard error of it.
    variance, sigma : float64 array, (kinds,)
        Of each kind of patterns, in squares of its unit, and standard errors.
    """

    white: float
    white_sigma: float
    variance: Float64[np.ndarray, " kinds"]
    sigma: Float64[np.ndarray, " kinds"]

    @classmethod
    def of(
        cls,
        views: list[ViewSums],
        kinds: Int64[np.ndarray, " patterns"],
        C: Float64[np.ndarray, "shared shared"],
        residuals: tuple[float, float],
    ) -> "VarianceComponents":
        """Return the components of the residuals of some views.

        Parameters
        ----------
        views : list of ViewSums
        kinds : ndarray, shape (patterns,)
            Of each pattern of a view, from 0.
        C : ndarray, shape (shared, shared)
            Inverse of the normal equations by all that views share.
        residuals : (float, float)
            Sum of squares of these views' whitened residuals, and its degrees of freedom.

        Notes
        -----
        Least-squares estimation of variance components (Teunissen and Amiri-Simkooei 2008; with independent
        errors as prior it is Rao's MINQUE, 1971). The residuals are P y with the projection P of the fit. For
        patterns F of each kind the expected square of F' P y is the sum over kinds of tr(F_i' P F_j F_j' P
        F_i) times their variances: a shift that poses and lenses have absorbed is thereby allowed for.
        Variances are not negative. Standard errors are those of normal errors with the variances found.
        """
        kind = np.tile(kinds, len(views))
        number = int(kinds.max()) + 1
        shared = np.concatenate([view.shared for view in views], axis=1)
        B = -(shared.T @ (C @ shared))
        for at, view in enumerate(views):
            own = slice(at * len(kinds), (at + 1) * len(kinds))
            B[own, own] += view.square
        member = (kind == np.arange(number)[:, None]).astype(np.float64)
        squares, freedom = residuals
        S = np.empty((1 + number, 1 + number))
        S[0, 0] = freedom
        S[0, 1:] = S[1:, 0] = member @ np.diagonal(B)
        S[1:, 1:] = member @ (B * B.T) @ member.T
        found = np.concatenate([view.found for view in views]) ** 2
        q = np.array([squares, *(member @ found)])
        # Units of each kind differ by far.
        unit = np.sqrt(np.diagonal(S))
        S, q = S / np.outer(unit, unit), q / unit
        root = np.linalg.cholesky(S + 1e-12 * np.eye(len(S)))
        s, _ = scipy.optimize.nnls(root.T, np.linalg.solve(root, q))
        by_kind = s[1:] / unit[1:]
        spread = _covariance_of_squares(B, member, (float(s[0] / unit[0]), by_kind), freedom)
        spread = spread / np.outer(unit, unit)
        sigma = np.sqrt(np.diagonal(np.linalg.solve(S, np.linalg.solve(S, spread).T))) / unit
        return cls(float(s[0] / unit[0]), float(sigma[0]), by_kind, sigma[1:])


def _covariance_of_squares(
    B: Float64[np.ndarray, "n n"],
    member: Float64[np.ndarray, "kinds n"],
    variances: tuple[float, Float64[np.ndarray, " kinds"]],
    freedom: float,
) -> Float64[np.ndarray, "components components"]:
    """Return the covariance of the sums of squares, of normal errors with these variances.

    With V the covariance of errors and B = F' P F, squares of F_i' P y and F_j' P y have the covariance
    2 |F_i' P V P F_j|^2, where F' P V P F = white B + B D B with the variances D by pattern.
    """
    white, by_kind = variances
    D = member.T @ by_kind
    scaled = B * D
    W = white * B + scaled @ B
    found = np.empty((1 + len(member), 1 + len(member)))
    found[0, 0] = white**2 * freedom + 2.0 * white * np.trace(scaled) + (scaled * scaled.T).sum()
    along = white**2 * np.diagonal(B) + np.einsum("ij,ji->i", scaled, white * B + W)
    found[0, 1:] = found[1:, 0] = member @ along
    found[1:, 1:] = member @ (W * W.T) @ member.T
    return 2.0 * found
