"""Tilt and radius of flat round dots in space, from their outlines in several pictures."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Vectors3

_STARTS = 6
_START_SLOPE = 0.5
_STEPS = 15
_STEP = 1e-6
"""Of slopes, for derivatives by differences."""
_MOST_SLOPE = 6.0
"""Beyond it a dot is seen from its edge: no outline is traced."""
_LADDER = tuple(0.005 * 2.0**k for k in range(9))
"""Slopes at which the rise of the cost is looked at."""
_OUTLINE_FLOOR_PX = 0.02
"""Standard deviation of outlines beyond noise: prints are not round, lenses bend outlines."""
_RIVAL = 9.0
"""Chi-square by which another minimum is worse and no longer counts."""
_APART, _NEAR = 1e-3, 0.1
"""Slopes, and share of one, by which minima that are one differ at most."""


@dataclass(frozen=True)
class Outlines3:
    """Outlines of n dots in several pictures, with what they say of a disc's tilt.

    Attributes
    ----------
    by_point : ndarray, shape (n, cameras, 2, 3)
        Derivatives of pixels by the dots' centres, px/mm.
    outline : ndarray, shape (n, cameras, 2, 2)
        Matrices S of outlines, px squared; NaN where a picture has none.
    sigma : ndarray, shape (n, cameras)
        Standard deviation of the dots' pixels along an axis, px.
    towards : ndarray, shape (n, 3)
        Unit vectors from the dots to the cameras, on average.
    """

    by_point: Float64[np.ndarray, "n cameras 2 3"]
    outline: Float64[np.ndarray, "n cameras 2 2"]
    sigma: Float64[np.ndarray, "n cameras"]
    towards: Vectors3


@dataclass(frozen=True)
class DiscFits:
    """Discs that explain the outlines, each with `k` tilts: the best, its limits, and the best rival.

    Attributes
    ----------
    normal : ndarray, shape (n, 6, 3)
        Unit normals towards the cameras: the best one; two limits of a standard deviation along each of two
        directions; the best of another minimum, or the best one again.
    radius_mm : ndarray, shape (n, 6)
        Radii that go with them.
    rival : ndarray, shape (n,)
        Probability of the other minimum, 0 to a half.
    chi_square : ndarray, shape (n,)
        Of the best one.
    freedom : ndarray, shape (n,)
        Its degrees of freedom.
    ok : ndarray of bool, shape (n,)
        Whether two pictures or more show an outline.
    """

    normal: Float64[np.ndarray, "n 6 3"]
    radius_mm: Float64[np.ndarray, "n 6"]
    rival: Float64[np.ndarray, " n"]
    chi_square: Float64[np.ndarray, " n"]
    freedom: np.ndarray
    ok: Mask


def fit_discs(seen: Outlines3) -> DiscFits:
    """Fit a disc to the outlines of each dot, by least squares of outlines' matrices.

    Parameters
    ----------
    seen : Outlines3

    Notes
    -----
    A disc of radius R with the unit normal n has the outline ``R^2 J (I - n n') J'`` where it is small beside
    its distance, J being the derivative of pixels by places. R squared enters linearly and is eliminated
    (variable projection, Golub and Pereyra 1973). Edge points whose errors are independent with equal
    variances move the centre of a circle along an axis by a standard deviation sigma, its second harmonics by
    sigma as well, and its radius by sigma over the root of 2, which determines the weights. The ellipse in
    one picture has two tilts; those of several pictures agree in one, as a rule.
    """
    frame = _frames(seen.towards)
    shapes = _Shapes.of(seen)
    turns = 2.0 * np.pi * np.arange(_STARTS) / _STARTS
    starts = _START_SLOPE * np.stack([np.cos(turns), np.sin(turns)], axis=-1)
    n = len(seen.towards)
    many = shapes.repeated(_STARTS)
    frames = np.repeat(frame, _STARTS, axis=0)
    found = _minimised(np.tile(starts, (n, 1)), frames, many)
    cost = many.cost(found, frames).reshape(n, _STARTS)
    slopes = found.reshape(n, _STARTS, 2)
    row = np.arange(n)
    first = np.argmin(cost, axis=1)
    best, least = slopes[row, first], cost[row, first]
    one = np.maximum(_APART, _NEAR * np.hypot(*best.T))
    apart = np.linalg.norm(slopes - best[:, None], axis=2) > one[:, None]
    other_cost = np.where(apart, cost, np.inf)
    second = np.argmin(other_cost, axis=1)
    worse = other_cost[row, second] - least
    is_rival = worse < _RIVAL
    other = np.where(is_rival[:, None], slopes[row, second], best)
    odds = np.exp(-0.5 * np.where(is_rival, worse, np.inf))
    every = np.stack([best, *_limits(best, least, frame, shapes), other], axis=1)
    k = every.shape[1]
    flat, frames = every.reshape(-1, 2), np.repeat(frame, k, axis=0)
    square = shapes.repeated(k).radius_squared(flat, frames)
    pictures = shapes.there.sum(axis=1)
    return DiscFits(
        normal=_normals(flat, frames).reshape(n, k, 3),
        radius_mm=np.sqrt(np.maximum(square, 0.0)).reshape(n, k),
        rival=odds / (1.0 + odds),
        chi_square=least,
        freedom=3 * pictures - 3,
        ok=pictures > 1,
    )


@dataclass(frozen=True)
class _Shapes:
    """Outlines as they enter: pixels scaled so that every measured outline is the unit circle."""

    by_point: Float64[np.ndarray, "n cameras 2 3"]
    """Scaled."""
    weight: Float64[np.ndarray, "n cameras 3"]
    """Of the mean and of the two second harmonics of an outline; 0 where there is none."""
    there: Mask
    """(n, cameras)"""

    @classmethod
    def of(cls, seen: Outlines3) -> "_Shapes":
        there = np.isfinite(seen.outline).all(axis=(2, 3)) & np.isfinite(seen.by_point).all(axis=(2, 3))
        S = np.where(there[..., None, None], seen.outline, np.eye(2))
        scaled = np.linalg.solve(np.linalg.cholesky(S), np.where(there[..., None, None], seen.by_point, 0.0))
        sigma = np.hypot(np.where(there, seen.sigma, 1.0), _OUTLINE_FLOOR_PX)
        relative = sigma / np.sqrt(np.sqrt(np.linalg.det(S)))
        weight = np.where(there, 1.0 / relative, 0.0)[..., None] * np.array([np.sqrt(2.0), 1.0, 1.0])
        return cls(scaled, weight, there)

    def repeated(self, times: int) -> "_Shapes":
        """Return every dot so many times."""
        return _Shapes(*(np.repeat(part, times, axis=0) for part in (self.by_point, self.weight, self.there)))

    def _parts(self, slopes: np.ndarray, frame: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Return modes of the outlines of a disc of radius 1, and of those measured, both weighted."""
        along = np.einsum("ncij,nj->nci", self.by_point, _normals(slopes, frame))
        M = self.by_point @ self.by_point.swapaxes(2, 3) - along[..., :, None] * along[..., None, :]
        modes = np.stack(
            [0.25 * (M[..., 0, 0] + M[..., 1, 1]), 0.25 * (M[..., 0, 0] - M[..., 1, 1]), 0.5 * M[..., 0, 1]],
            axis=-1,
        )
        measured = self.weight * np.array([0.5, 0.0, 0.0])
        return (self.weight * modes).reshape(len(modes), -1), measured.reshape(len(modes), -1)

    def radius_squared(self, slopes: np.ndarray, frame: np.ndarray) -> np.ndarray:
        """Return the best radii squared, mm squared."""
        modes, measured = self._parts(slopes, frame)
        return np.asarray((modes * measured).sum(axis=1) / np.maximum((modes**2).sum(axis=1), 1e-300))

    def residual(self, slopes: np.ndarray, frame: np.ndarray) -> np.ndarray:
        """Return weighted residuals with the best radii, (n, 3 cameras)."""
        modes, measured = self._parts(slopes, frame)
        square = (modes * measured).sum(axis=1) / np.maximum((modes**2).sum(axis=1), 1e-300)
        return np.asarray(square[:, None] * modes - measured)

    def cost(self, slopes: np.ndarray, frame: np.ndarray) -> np.ndarray:
        """Return sums of squared residuals."""
        return np.asarray((self.residual(slopes, frame) ** 2).sum(axis=1))


def _frames(towards: Vectors3) -> Float64[np.ndarray, "n 3 3"]:
    """Return frames whose first row is a direction."""
    least = np.eye(3)[np.argmin(np.abs(towards), axis=1)]
    second = np.cross(towards, least)
    second /= np.linalg.norm(second, axis=1, keepdims=True)
    return np.stack([towards, second, np.cross(towards, second)], axis=1)


def _normals(slopes: np.ndarray, frame: np.ndarray) -> np.ndarray:
    """Return unit normals of slopes across a direction."""
    normal = frame[:, 0] + slopes[:, :1] * frame[:, 1] + slopes[:, 1:] * frame[:, 2]
    return np.asarray(normal / np.linalg.norm(normal, axis=1, keepdims=True))


def _normal_equations(
    slopes: np.ndarray, frame: np.ndarray, shapes: _Shapes
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return residuals, and gradient and normal matrix of the slopes."""
    r = shapes.residual(slopes, frame)
    J = np.stack([(shapes.residual(slopes + step, frame) - r) / _STEP for step in _STEP * np.eye(2)], axis=-1)
    return r, np.einsum("nri,nr->ni", J, r), np.einsum("nri,nrj->nij", J, J)


def _minimised(slopes: np.ndarray, frame: np.ndarray, shapes: _Shapes) -> np.ndarray:
    """Return slopes of a minimum near each start, by Levenberg's steps."""
    damping = np.full(len(slopes), 1e-2)
    for _ in range(_STEPS):
        r, gradient, normal = _normal_equations(slopes, frame, shapes)
        scale = np.maximum(np.trace(normal, axis1=1, axis2=2), 1e-12)
        damped = normal + (damping * scale)[:, None, None] * np.eye(2)
        step = -np.linalg.solve(damped, gradient[..., None])[..., 0]
        tried = np.clip(slopes + step, -_MOST_SLOPE, _MOST_SLOPE)
        better = shapes.cost(tried, frame) < (r**2).sum(axis=1)
        slopes = np.where(better[:, None], tried, slopes)
        damping = np.where(better, 0.2 * damping, 5.0 * damping)
    return slopes


def _limits(best: np.ndarray, least: np.ndarray, frame: np.ndarray, shapes: _Shapes) -> list[np.ndarray]:
    """Return slopes at which the cost has risen by 1, either way along two directions.

    The normal matrix is of no use where a dot is seen from the front: there an outline changes by the square
    of a slope.
    """
    normal = _normal_equations(best, frame, shapes)[2]
    axes = np.linalg.eigh(normal)[1]
    found = []
    for number in range(2):
        for sign in (1.0, -1.0):
            reach = np.full(len(best), _LADDER[-1])
            for step in reversed(_LADDER):
                risen = shapes.cost(best + sign * step * axes[:, :, number], frame) - least
                # Between two rungs the cost is a parabola that stands on the best.
                reach = np.where(risen >= 1.0, step / np.sqrt(np.maximum(risen, 1.0)), reach)
            found.append(best + sign * reach[:, None] * axes[:, :, number])
    return found
