"""The pinhole and the Brown-Conrady lens (Brown 1966), in OpenCV's order k1 k2 p1 p2 k3."""

from dataclasses import dataclass

import numpy as np

from labcal.cameras.mathematics import Mathematics, Number

LENGTH = 5
"""OpenCV's shortest coefficient vector that it takes everywhere."""


_FLAT = 1e-6
"""Jacobian determinant below which Newton's step would leave the part of the lens that has an inverse."""


def distort(numbers: tuple[Number, ...], x: Number, y: Number) -> tuple[Number, Number]:
    """Return the distorted position of an ideal one, both at unit focal length."""
    k1, k2, p1, p2, k3 = numbers[:LENGTH]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    return (
        x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
        y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y,
    )


def distort_jacobian(numbers: tuple[Number, ...], x: Number, y: Number) -> tuple[Number, Number, Number]:
    """Return dx'/dx, dx'/dy (equal to dy'/dx) and dy'/dy of :func:`distort`."""
    k1, k2, p1, p2, k3 = numbers[:LENGTH]
    r2 = x * x + y * y
    radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3))
    slope = 2.0 * (k1 + r2 * (2.0 * k2 + r2 * (3.0 * k3)))
    return (
        radial + x * x * slope + 2.0 * p1 * y + 6.0 * p2 * x,
        x * y * slope + 2.0 * p1 * x + 2.0 * p2 * y,
        radial + y * y * slope + 6.0 * p1 * y + 2.0 * p2 * x,
    )


def fold_radius_squared(dist: np.ndarray) -> float:
    """Return r squared where the radial part stops growing, infinity where it never does.

    Beyond this radius two directions share one image, so the model says nothing there.
    """
    k1, k2, _, _, k3 = (float(k) for k in dist[:LENGTH])
    roots = np.roots([7.0 * k3, 5.0 * k2, 3.0 * k1, 1.0])
    folds = [float(root.real) for root in roots if abs(root.imag) <= 1e-12 * abs(root) and root.real > 0.0]
    return min(folds, default=float("inf"))


@dataclass(frozen=True)
class Brown:
    """Brown-Conrady with the first `coefficients` of k1 k2 p1 p2 k3 free and the rest zero; 0: a pinhole."""

    name: str
    coefficients: int

    def numbers(self, dist: np.ndarray) -> tuple[float, ...]:
        """Return k1 k2 p1 p2 k3 and the squared radius of the fold."""
        return (*(float(k) for k in dist[:LENGTH]), fold_radius_squared(dist))

    def image(
        self, m: Mathematics, numbers: tuple[Number, ...], X: Number, Y: Number, Z: Number
    ) -> tuple[Number, Number, Number]:
        """Return ``x, y, ok``; not ok behind the camera and beyond the fold."""
        front = Z > 0.0
        depth = m.where(front, Z, 1.0)
        x, y = X / depth, Y / depth
        ok = front & (x * x + y * y < numbers[LENGTH])
        if self.coefficients == 0:
            return x, y, ok
        return *distort(numbers, x, y), ok

    def direction(
        self, m: Mathematics, numbers: tuple[Number, ...], x: Number, y: Number
    ) -> tuple[Number, Number, Number, Number]:
        """Return ``X, Y, Z, ok`` by Newton's method; not ok where it does not converge."""
        ix, iy = x, y
        ok = x == x  # noqa: PLR0124 -- false for NaN, in any number
        if self.coefficients:
            # From the distorted position Newton nears a barrel from below, and never crosses the fold.
            for _ in range(m.newton_steps):
                fx, fy = distort(numbers, ix, iy)
                ex, ey = fx - x, fy - y
                a, b, d = distort_jacobian(numbers, ix, iy)
                det = a * d - b * b
                safe = m.where(det > _FLAT, det, 1.0)
                ix, iy = ix - (d * ex - b * ey) / safe, iy - (a * ey - b * ex) / safe
            fx, fy = distort(numbers, ix, iy)
            ex, ey = fx - x, fy - y
            a, b, d = distort_jacobian(numbers, ix, iy)
            limit = m.tolerance * (1.0 + m.sqrt(x * x + y * y))
            ok = (
                ok
                & (ex * ex + ey * ey < limit * limit)
                & (ix * ix + iy * iy < numbers[LENGTH])
                & (a * d - b * b > 0.0)
            )
        length = m.sqrt(ix * ix + iy * iy + 1.0)
        return ix / length, iy / length, 1.0 / length, ok

    def image_jacobian(
        self, numbers: tuple[float, ...], X: np.ndarray, Y: np.ndarray, Z: np.ndarray
    ) -> np.ndarray:
        """Return d(x, y) / d(X, Y, Z), shape (..., 2, 3)."""
        x, y = X / Z, Y / Z
        a, b, d = distort_jacobian(numbers, x, y)
        jacobian = np.empty((*np.shape(x), 2, 3))
        jacobian[..., 0, 0] = a / Z
        jacobian[..., 0, 1] = b / Z
        jacobian[..., 0, 2] = -(a * x + b * y) / Z
        jacobian[..., 1, 0] = b / Z
        jacobian[..., 1, 1] = d / Z
        jacobian[..., 1, 2] = -(b * x + d * y) / Z
        return jacobian

    def coefficient_jacobian(self, X: np.ndarray, Y: np.ndarray, Z: np.ndarray) -> np.ndarray:
        """Return d(x, y) / d(k1 k2 p1 p2 k3), the free ones, shape (..., 2, coefficients)."""
        x, y = X / Z, Y / Z
        r2 = x * x + y * y
        columns = [
            (x * r2, y * r2),
            (x * r2**2, y * r2**2),
            (2.0 * x * y, r2 + 2.0 * y * y),
            (r2 + 2.0 * x * x, 2.0 * x * y),
            (x * r2**3, y * r2**3),
        ]
        jacobian = np.empty((*np.shape(x), 2, self.coefficients))
        for i, (dx, dy) in enumerate(columns[: self.coefficients]):
            jacobian[..., 0, i] = dx
            jacobian[..., 1, i] = dy
        return jacobian
