"""Hyperparameters of a residual field by restricted maximum likelihood."""

from dataclasses import dataclass
from itertools import product

import numpy as np
import scipy.linalg
from jaxtyping import Float64
from scipy.optimize import minimize

from labcal.estimators.gp_field.kernel import FieldKernel
from labcal.rng import generator

_BOUNDS = np.log([[1e-4, 1e10], [0.02, 30.0], [0.02, 30.0], [2.0 * np.pi, 200.0]])
"""Of the field's variance over the noise's, of the lengths across and along, and of the wavenumber, if there
is one; the inputs' training range is about 1."""
_RATIOS, _ACROSS, _ALONG = (1.0, 1e2, 1e4, 1e6), (0.06, 0.12, 0.25, 0.5), (0.6, 2.0, 8.0)
"""Of all of these together, the search begins at the likeliest."""
_WAVENUMBERS, _TRAINS = tuple(2.0 * np.pi * np.arange(1.5, 10.5, 0.4)), (0.4, 2.0)
"""Of waves, and the lengths over which their trains decay: the search begins at the likeliest place of each
train. Trains across all of the picture tell wavenumbers apart that differ by half a turn over it."""
_LOUD = (1e2, 1e4)
"""Ratios of variances of waves; one of a field without waves is none of theirs, if that has missed them."""
_GLANCED = 300
"""Points, drawn from all, that tell where the search for waves begins."""
_WORTH = 6.0
"""Gain of the logarithm of the likelihood from which on a field is there: by chance, three numbers more gain
this once in some hundred cases (Wilks 1938: half a chi-square)."""
_STEPS = {"maxiter": 50, "ftol": 1e-6}
_NOWHERE = np.array([-np.inf, 0.0, 0.0])
Logs = Float64[np.ndarray, "_"]
"""Logarithms of three hyperparameters, or of four where there are waves."""


@dataclass(frozen=True)
class FieldScale:
    """The hyperparameters of a field.

    Attributes
    ----------
    kernel : FieldKernel
    amplitude_px : float
        Standard deviation of each coordinate of the field; 0 where there is none.
    noise_px : float
        Standard deviation of each coordinate of a measurement.
    gain : float
        How much more likely the residuals are with the field than without, in natural logarithms.
    """

    kernel: FieldKernel
    amplitude_px: float
    noise_px: float
    gain: float

    def root(self, x: Float64[np.ndarray, "n 3"]) -> Float64[np.ndarray, "n n"]:
        """Return the lower Cholesky factor of the covariance of measurements at places, px."""
        V = self.amplitude_px**2 * self.kernel.between(x, x)
        V[np.diag_indices_from(V)] += self.noise_px**2
        return np.asarray(scipy.linalg.cholesky(V, lower=True, overwrite_a=True, check_finite=False))


def field_scale(
    x: Float64[np.ndarray, "n 3"],
    residual: Float64[np.ndarray, "n 2"],
    by_camera: Float64[np.ndarray, "n 2 free"],
    near: FieldScale | None = None,
) -> tuple[FieldScale, float]:
    """Return the best field of residuals while the parameters of the camera are free, and its likelihood.

    How well is the restricted log-likelihood but for a constant, in natural logarithms: of the same pixels it
    can be compared between cameras.

    Parameters
    ----------
    x : ndarray, shape (n, 3)
        Two coordinates of the picture and one of depth, each with a training range of about 1.
    residual : ndarray, shape (n, 2)
        Measured minus predicted by the camera, px.
    by_camera : ndarray, shape (n, 2, free)
        Derivatives of the prediction; those by what no pixel depends on, as the depth of a camera with
        parallel rays, are 0 and count for nothing.
    near : FieldScale, optional
        Where to begin.

    Notes
    -----
    The likelihood is restricted to what the camera's parameters cannot take up (Patterson and Thompson
    1971), so that the field is neither starved by a camera that has absorbed it nor asked to explain what
    the camera can. The noise's variance follows in closed form.
    """
    seen = (by_camera != 0.0).any(axis=(0, 1))
    likelihood = _Restricted(
        x, residual, by_camera if seen.all() else np.ascontiguousarray(by_camera[..., seen])
    )
    if near is not None and near.amplitude_px > 0.0:
        best = likelihood.best_from(_logs(near))
    else:
        start = min((np.log(place) for place in product(_RATIOS, _ACROSS, _ALONG)), key=likelihood.cost)
        best = likelihood.best_with_waves(likelihood.best_from(start))
    without, cost = likelihood.cost(_NOWHERE), likelihood.cost(best)
    gain = without - cost
    if gain < _WORTH:
        return FieldScale(_kernel(_NOWHERE), 0.0, likelihood.noise(_NOWHERE), 0.0), -without
    noise = likelihood.noise(best)
    amplitude = float(np.exp(0.5 * best[0])) * noise
    return FieldScale(_kernel(best), amplitude, noise, gain), -cost


def _logs(scale: FieldScale) -> Logs:
    """Return the logarithms of a field's hyperparameters."""
    kernel, ratio = scale.kernel, (scale.amplitude_px / scale.noise_px) ** 2
    waves = [kernel.wavenumber] if kernel.wavenumber > 0.0 else []
    return np.log([ratio, kernel.across, kernel.along, *waves])


def _kernel(logs: Logs) -> FieldKernel:
    """Return the kernel of logarithms: ratio of variances, across, along, and the wavenumber of waves."""
    _, across, along, *waves = np.exp(logs).tolist()
    return FieldKernel(across, along, *waves)


@dataclass(frozen=True)
class _Parts:
    """Terms of the likelihood at given hyperparameters, in units of the noise."""

    root: Float64[np.ndarray, "n n"]
    """Cholesky factor of W, the covariance over the noise's variance."""
    basis: Float64[np.ndarray, "n 2 free"]
    """Orthonormal in the whitened space: what the camera can take up."""
    left: Float64[np.ndarray, "n 2"]
    """Whitened residuals without that."""
    half_determinants: float


@dataclass(frozen=True)
class _Restricted:
    """Minus the restricted log-likelihood, by logarithms (see :func:`_kernel`)."""

    x: Float64[np.ndarray, "n 3"]
    residual: Float64[np.ndarray, "n 2"]
    by_camera: Float64[np.ndarray, "n 2 free"]

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

    def best_with_waves(self, without: Logs) -> Logs:
        """Return the hyperparameters of a field of waves, or those without if waves gain too little."""
        cost = self.cost(without)
        if self.cost(_NOWHERE) - cost < _WORTH:
            return without
        along = float(np.exp(without[2]))
        glance = self._thinned()
        ends = []
        for train in _TRAINS:
            starts = (np.log(place) for place in product(_LOUD, (train,), (along,), _WAVENUMBERS))
            ends.append(self.best_from(min(starts, key=glance.cost)))
        best = min(ends, key=self.cost)
        return best if cost - self.cost(best) >= _WORTH else without

    def _thinned(self) -> "_Restricted":
        """Return that of some of the points."""
        n = len(self.x)
        if n <= _GLANCED:
            return self
        some = np.sort(generator(0, "waves of a field").permutation(n)[:_GLANCED])
        return _Restricted(self.x[some], self.residual[some], self.by_camera[some])

    def cost(self, logs: Logs) -> float:
        """Return it, the noise's variance being the best one."""
        return self._cost(self._parts(self._covariance(logs)))

    def cost_and_slopes(self, logs: Logs) -> tuple[float, Logs]:
        """Return it, and its derivatives.

        With W' the derivative of W and P what whitens and projects, that of the cost is
        ``tr(P W') - r' P W' P r / (2 s^2)``, the trace over both coordinates.
        """
        W = self._covariance(logs)
        parts = self._parts(W)
        inverse = _solved_back(parts.root, np.eye(len(W)))
        weights = _solved_back(parts.root, parts.left)
        basis = _solved_back(parts.root, parts.basis.reshape(len(W), -1))
        # Half of tr(P W') is summed over elements: W' is symmetric, and so is the matrix it meets.
        half_projector = inverse @ inverse.T - 0.5 * (basis @ basis.T)
        meets = half_projector - 0.5 * (weights @ weights.T) / self._variance(parts)
        smooth = W - np.eye(len(W))
        slopes = [float((meets * smooth).sum())]
        kernel = _kernel(logs)
        for columns, length in ((slice(2), kernel.across), (slice(2, 3), kernel.along)):
            square = _square(self.x[:, columns]) / length**2
            slopes.append(float((meets * smooth * square).sum()))
        if kernel.wavenumber > 0.0:
            ratio = float(np.exp(logs[0]))
            slopes.append(float((meets * kernel.by_wavenumber(self.x, self.x)).sum()) * ratio)
        return self._cost(parts), np.array(slopes)

    def noise(self, logs: Logs) -> float:
        """Return the best standard deviation of the noise, px."""
        return float(np.sqrt(self._variance(self._parts(self._covariance(logs)))))

    @property
    def _freedom(self) -> int:
        return int(max(1, self.residual.size - self.by_camera.shape[2]))

    def _variance(self, parts: _Parts) -> float:
        return float((parts.left**2).sum()) / self._freedom

    def _cost(self, parts: _Parts) -> float:
        return 0.5 * self._freedom * float(np.log(self._variance(parts))) + parts.half_determinants

    def _covariance(self, logs: Logs) -> Float64[np.ndarray, "n n"]:
        """Return that of measurements over the noise's variance."""
        ratio = float(np.exp(logs[0]))
        if ratio == 0.0:
            return np.eye(len(self.x))
        return np.asarray(ratio * _kernel(logs).between(self.x, self.x) + np.eye(len(self.x)))

    def _parts(self, W: Float64[np.ndarray, "n n"]) -> _Parts:
        n = len(W)
        root = scipy.linalg.cholesky(W, lower=True, check_finite=False)
        both = np.concatenate([self.residual, self.by_camera.reshape(n, -1)], axis=1)
        both = scipy.linalg.solve_triangular(root, both, lower=True, check_finite=False)
        r, J = both[:, :2].ravel(), both[:, 2:].reshape(2 * n, -1)
        Q, R = np.linalg.qr(J / np.linalg.norm(self.by_camera.reshape(2 * n, -1), axis=0))
        left = r - Q @ (Q.T @ r)
        half = 2.0 * float(np.log(np.diagonal(root)).sum()) + float(np.log(np.abs(np.diagonal(R))).sum())
        return _Parts(root, Q.reshape(n, 2, -1), left.reshape(n, 2), half)


def _solved_back(root: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Return the inverse of the transposed root times values."""
    return np.asarray(scipy.linalg.solve_triangular(root, values, lower=True, trans=1, check_finite=False))


def _square(a: np.ndarray) -> np.ndarray:
    """Return squared distances of all pairs, (n, n)."""
    inner = a @ a.T
    own = np.diagonal(inner)
    return np.asarray(np.maximum(own[:, None] + own - 2.0 * inner, 0.0))
