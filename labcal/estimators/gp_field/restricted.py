"""The restricted likelihood of a residual field, by its hyperparameters."""

from dataclasses import dataclass, replace

import numpy as np
import scipy.linalg
from jaxtyping import Float64
from scipy.optimize import minimize

from labcal.estimators.gp_field.kernel import FieldKernel
from labcal.estimators.gp_field.waves import ALL_ALIKE, Spread, squared_distances, waves_of

_BOUNDS = np.log([[1e-4, 1e10], [0.02, 30.0], [0.02, 30.0], [2.0 * np.pi, 200.0]])
"""Of the field's variance over the noise's, of the lengths across and along, and of the wavenumber, if there
is one; the inputs' training range is about 1."""
_STEPS = {"maxiter": 50, "ftol": 1e-6}
Logs = Float64[np.ndarray, "_"]
"""Logarithms of three hyperparameters, or of four where there are waves."""
NO_FIELD = np.array([-np.inf, 0.0, 0.0])


@dataclass(frozen=True)
class Derivatives:
    """The elements that meet a derivative W' of the covariance over the noise's variance in sums.

    Attributes
    ----------
    half_projector : float64 array, (n, n)
        Half of ``tr(P W')`` over both coordinates is the sum of ``half_projector * W'``.
    explained : float64 array, (n, n)
        ``r' P W' P r`` over the variance of the noise is the sum of ``explained * W'``.
    """

    half_projector: Float64[np.ndarray, "n n"]
    explained: Float64[np.ndarray, "n n"]


@dataclass(frozen=True)
class _Parts:
    """Terms of the likelihood at given hyperparameters, in units of the noise."""

    root: Float64[np.ndarray, "n n"]
    """Cholesky factor of W, the covariance over the noise's variance."""
    basis: Float64[np.ndarray, "n 2 free"]
    """Orthonormal in the whitened space: what the camera can take up."""
    left: Float64[np.ndarray, "n 2"]
    """Whitened residuals without that."""
    square: float
    """Sum of squares of whitened residuals and random effects."""
    half_determinants: float


@dataclass(frozen=True)
class RestrictedLikelihood:
    """Minus the logarithm of a field's restricted likelihood, but for a constant.

    The likelihood is restricted to what the camera's parameters cannot take up (Patterson and Thompson 1971).
    The noise's variance follows in closed form. Hyperparameters are logarithms: of the field's variance over
    the noise's, of the lengths across and along, and of the wavenumber where there are waves.

    Attributes
    ----------
    x : float64 array, (n, 3)
        Two coordinates of the picture and one of depth, each with a training range of about 1.
    residual : float64 array, (n, 2)
        Measured minus predicted by the camera, px.
    by_camera : float64 array, (n, 2, free)
        Derivatives of the prediction.
    spread : Spread
        Of waves, where there are some.
    by_stage : float64 array, (n, 2, effects), optional
        What errors of a stage do to the residuals, px by their standard deviations: random effects beside the
        field.
    noise_px : float
        Standard deviation of the noise, over which that of the random effects is taken.
    """

    x: Float64[np.ndarray, "n 3"]
    residual: Float64[np.ndarray, "n 2"]
    by_camera: Float64[np.ndarray, "n 2 free"]
    spread: Spread = ALL_ALIKE
    by_stage: Float64[np.ndarray, "n 2 effects"] | None = None
    noise_px: float = 1.0

    def with_spread(self, spread: Spread) -> "RestrictedLikelihood":
        """Return that of the same residuals with waves of other directions."""
        return replace(self, spread=spread)

    def kernel(self, logs: Logs) -> FieldKernel:
        """Return the kernel of hyperparameters."""
        _, across, along, *wavenumber = np.exp(logs).tolist()
        return FieldKernel(across, along, waves_of(wavenumber[0], self.spread) if wavenumber else None)

    def best_from(self, start: Logs) -> Logs:
        """Return the hyperparameters with the least cost near some."""
        end = minimize(
            self.cost_and_slopes,
            start,
            method="L-BFGS-B",
            jac=True,
            bounds=_BOUNDS[: len(start)],
            options=_STEPS,
        )
        return np.asarray(end.x)

    def cost(self, logs: Logs) -> float:
        """Return it, the noise's variance being the best one."""
        return self._cost(self._parts(self.covariance(logs)))

    def cost_and_slopes(self, logs: Logs) -> tuple[float, Logs]:
        """Return it, and its derivatives.

        With W' the derivative of W and P what whitens and projects, that of the cost is
        ``tr(P W') - r' P W' P r / (2 s^2)``, the trace over both coordinates.
        """
        W = self.covariance(logs)
        parts = self._parts(W)
        derivatives = self._derivatives(parts)
        meets = derivatives.half_projector - 0.5 * derivatives.explained
        smooth = W - np.eye(len(W))
        slopes = [float((meets * smooth).sum())]
        kernel = self.kernel(logs)
        for columns, length in ((slice(2), kernel.across), (slice(2, 3), kernel.along)):
            own = self.x[:, columns]
            square = squared_distances(own, own) / length**2
            slopes.append(float((meets * smooth * square).sum()))
        if kernel.waves is not None:
            turned = kernel.by_wavenumber(self.x, self.x)
            slopes.append(float((meets * turned).sum()) * float(np.exp(logs[0])))
        return self._cost(parts), np.array(slopes)

    def derivatives(self, W: Float64[np.ndarray, "n n"]) -> Derivatives:
        """Return what derivatives of the cost are made of, at a covariance over the noise's variance."""
        return self._derivatives(self._parts(W))

    def noise(self, logs: Logs) -> float:
        """Return the best standard deviation of the noise, px."""
        return float(np.sqrt(self._variance(self._parts(self.covariance(logs)))))

    def covariance(self, logs: Logs) -> Float64[np.ndarray, "n n"]:
        """Return that of measurements over the noise's variance."""
        ratio = float(np.exp(logs[0]))
        if ratio == 0.0:
            return np.eye(len(self.x))
        return np.asarray(ratio * self.kernel(logs).between(self.x, self.x) + np.eye(len(self.x)))

    def _derivatives(self, parts: _Parts) -> Derivatives:
        n = len(parts.root)
        inverse = _solved_back(parts.root, np.eye(n))
        weights = _solved_back(parts.root, parts.left)
        basis = _solved_back(parts.root, parts.basis.reshape(n, -1))
        # Half of tr(P W') is summed over elements: W' is symmetric, and so is the matrix it meets.
        half_projector = inverse @ inverse.T - 0.5 * (basis @ basis.T)
        return Derivatives(half_projector, (weights @ weights.T) / self._variance(parts))

    @property
    def _freedom(self) -> int:
        return int(max(1, self.residual.size - self.by_camera.shape[2]))

    def _variance(self, parts: _Parts) -> float:
        return parts.square / self._freedom

    def _cost(self, parts: _Parts) -> float:
        return 0.5 * self._freedom * float(np.log(self._variance(parts))) + parts.half_determinants

    def _parts(self, W: Float64[np.ndarray, "n n"]) -> _Parts:
        n = len(W)
        root = scipy.linalg.cholesky(W, lower=True, check_finite=False)
        both = np.concatenate([self.residual, self.by_camera.reshape(n, -1)], axis=1)
        both = scipy.linalg.solve_triangular(root, both, lower=True, check_finite=False)
        r, J = both[:, :2].ravel(), both[:, 2:].reshape(2 * n, -1)
        J = J / np.linalg.norm(self.by_camera.reshape(2 * n, -1), axis=0)
        if self.by_stage is not None:
            r, J = self._with_effects(self.by_stage, root, r, J)
        Q, R = np.linalg.qr(J)
        left = r - Q @ (Q.T @ r)
        square = float((left**2).sum())
        Q, left = Q[: 2 * n], left[: 2 * n]
        half = 2.0 * float(np.log(np.diagonal(root)).sum()) + float(np.log(np.abs(np.diagonal(R))).sum())
        return _Parts(root, Q.reshape(n, 2, -1), left.reshape(n, 2), square, half)

    def _with_effects(
        self, by_stage: np.ndarray, root: np.ndarray, r: np.ndarray, J: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray]:
        """Return whitened residuals and derivatives with those of random effects, which are measured as 0.

        The inverse of a covariance with random effects is that of least squares with a row more for each
        (Henderson 1975).
        """
        n, effects = len(root), by_stage.shape[2]
        flat = by_stage.reshape(n, -1)
        white = scipy.linalg.solve_triangular(root, flat, lower=True, check_finite=False).reshape(2 * n, -1)
        prior = np.concatenate([np.zeros((effects, J.shape[1])), self.noise_px * np.eye(effects)], axis=1)
        return np.concatenate([r, np.zeros(effects)]), np.concatenate([np.hstack([J, white]), prior])


def _solved_back(root: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the inverse of the transposed root times values."""
    return np.asarray(scipy.linalg.solve_triangular(root, values, lower=True, trans=1, check_finite=False))
