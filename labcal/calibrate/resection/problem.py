"""Resection as a problem for the Levenberg-Marquardt loop."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.linalg
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.lens_prior import PriorWidth, coefficient_weights
from labcal.calibrate.resection.placed import PlacedCamera
from labcal.errors import InputError
from labcal.optim.whitening import Whitening


@dataclass(frozen=True)
class ResectionProblem:
    """Make the whitened residuals of points small; a :class:`~labcal.optim.problem.Problem`.

    Attributes
    ----------
    q : float64 array, (n, 2)
        Where the points were measured, px.
    p : float64 array, (n, 3)
        World points, mm.
    whitening : Whitening
    prior : float64 array, (free,)
        Inverse variances of pose and free parameters, 0 for all but a lens's coefficients: about those of the
        lens without distortion.
    """

    q: Pixels
    p: Vectors3
    whitening: Whitening
    prior: Float64[np.ndarray, " free"]

    def cost(self, parameters: PlacedCamera) -> float:
        """Return the cost; infinite where a point cannot be imaged at all."""
        residual = parameters.camera.project(self.p).q - self.q
        if not np.isfinite(residual).all():
            return float("inf")
        deviations = parameters.free_parameters.deviations
        return float((self.whitening.whiten(residual) ** 2).sum() + self.prior[POSE:] @ deviations**2)

    def linearize(self, parameters: PlacedCamera) -> "ResectionEquations":
        """Return the normal equations at a camera."""
        seen = parameters.seen(self.p)
        J = self.whitening.whiten(seen.by_camera).reshape(-1, parameters.count)
        residual = self.whitening.whiten(seen.q - self.q).ravel()
        deviations = np.concatenate([np.zeros(POSE), parameters.free_parameters.deviations])
        return ResectionEquations(
            parameters, J.T @ J + np.diag(self.prior), J.T @ residual + self.prior * deviations
        )


@dataclass(frozen=True)
class ResectionEquations:
    """Normal equations; a :class:`~labcal.optim.problem.Linearization` that damps scaled parameters."""

    at: PlacedCamera
    matrix: Float64[np.ndarray, "free free"]
    gradient: Float64[np.ndarray, " free"]

    @cached_property
    def scale(self) -> Float64[np.ndarray, " free"]:
        """Roots of the curvatures; 1 for what is not observed."""
        curvature = np.diagonal(self.matrix)
        return np.where(curvature > 0.0, np.sqrt(np.maximum(curvature, 0.0)), 1.0)

    @property
    def gradient_norm(self) -> float:
        """Return how many standard deviations off the minimum is (the root of Newton's decrement)."""
        step = self._solved(1e-13)
        return float("inf") if step is None else float(np.sqrt(max(0.0, self.gradient @ step)))

    def stepped(self, mu: float) -> PlacedCamera | None:
        """Return the camera after a damped step, or None where it leads to none."""
        step = self._solved(mu)
        if step is None:
            return None
        try:
            return self.at.moved(-step)
        except (InputError, ValueError):
            return None

    @property
    def covariance(self) -> Float64[np.ndarray, "free free"]:
        """The inverse; of what is not observed, some very large variance, but 0 for a depth that is held."""
        curvature, axes = np.linalg.eigh(self.matrix / np.outer(self.scale, self.scale))
        floor = 1e-14 * curvature[-1]
        spread = (axes / np.maximum(curvature, floor)) @ axes.T
        covariance = np.asarray(spread / np.outer(self.scale, self.scale))
        if self.at.camera.model.parallel:
            covariance[POSE - 1] = covariance[:, POSE - 1] = 0.0
        return covariance

    def _solved(self, mu: float) -> Float64[np.ndarray, " free"] | None:
        damped = self.matrix / np.outer(self.scale, self.scale) + mu * np.eye(len(self.scale))
        try:
            factor = scipy.linalg.cho_factor(damped, lower=True, check_finite=True)
        except (np.linalg.LinAlgError, ValueError):
            return None
        return np.asarray(scipy.linalg.cho_solve(factor, self.gradient / self.scale) / self.scale)


def lens_prior(at: PlacedCamera, p: Vectors3, width: PriorWidth) -> Float64[np.ndarray, " free"]:
    """Return the inverse variances of a camera's pose and free parameters: those of its lens.

    Parameters
    ----------
    at : PlacedCamera
    p : ndarray, shape (n, 3)
        World points that it sees, mm.
    width : PriorWidth
    """
    prior = np.zeros(at.count)
    own = at.free_parameters.coefficients
    where = slice(POSE + own.start, POSE + own.stop)
    effect = np.abs(at.seen(p).by_camera[:, :, where]).max(axis=(0, 1), initial=0.0)
    prior[where] = coefficient_weights(at.camera, effect, width)
    return prior
