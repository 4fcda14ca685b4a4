"""Rays through two planes, each a polynomial of the pixel, for any camera whose rays are straight."""

from typing import ClassVar

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Vectors3
from labcal.calibrate.held_out import edges
from labcal.errors import InputError
from labcal.estimators.estimator import FittedArray
from labcal.estimators.linear_camera_estimator import LinearCameraEstimator
from labcal.estimators.linear_model_error import LinearModelError, Slopes
from labcal.estimators.scaling import RangeScaling
from labcal.geometry.arrangement import (
    camera_count,
    refuse_collinear,
    refuse_few,
    refuse_one_plane,
    refuse_other_than_points,
)
from labcal.geometry.projective_map import projective_map
from labcal.geometry.rays import closest_points
from labcal.geometry.two_by_two import inverses
from labcal.run.threads import one_blas_thread

CHOSEN = 0
"""In the place of a degree: the one that held-out edges choose."""
_HIGHEST = 9
_SINGULAR = 1e-12
"""Share of the largest singular value below which a direction of the coefficients counts as undetermined."""
_CAMERAS = 2


class TwoPlane(LinearCameraEstimator):
    """The method ``two-plane``: polynomials from the pixel to where its ray meets two planes.

    Martins, Birk and Kelley 1981; Wei and Ma 1993. The planes bound the trained volume, across the cameras'
    mean view. A ray's place at a depth between them is linear in the depth, so that all trained points enter
    one linear least-squares problem a camera, whether they lie on planes or not. Points are those nearest to
    the cameras' rays.

    Parameters
    ----------
    degree : int
        Of the polynomials in both pixel coordinates together; 0 for the one that predicts held-out edges of
        the picture best.

    Attributes
    ----------
    degrees_ : tuple of int
        By camera.
    rotation_ : float64 array, (3, 3)
        From the world to a frame whose z is the mean view.
    centre_, half_range_ : float64 array, (3,)
        The scaling of points in that frame, mm.
    pixel_centre_, pixel_half_range_ : float64 array, (inputs,)
        The scaling of pixels.
    coefficients_ : float64 array, (cameras, 2 terms, 2)
        Scaled x and y: of the middle plane, then of their change up to the far plane; zeros beyond a
        camera's own degree.
    """

    method: ClassVar[str] = "two-plane"
    fitted_facts: ClassVar[tuple[str, ...]] = ("degrees_",)

    def __init__(self, degree: int = CHOSEN) -> None:
        self.degree = degree

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        cameras, terms = len(self.degrees_), _term_count(max(self.degrees_))
        return (
            FittedArray("rotation_", (3, 3)),
            FittedArray("centre_", (3,)),
            FittedArray("half_range_", (3,)),
            FittedArray("pixel_centre_", (2 * cameras,)),
            FittedArray("pixel_half_range_", (2 * cameras,)),
            FittedArray("coefficients_", (cameras, 2 * terms, 2)),
        )

    @one_blas_thread()
    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        cameras = camera_count(self.method, pixels.shape[1])
        if cameras < _CAMERAS:
            raise InputError(
                f"{self.method}: X has the columns of one camera, but triangulation needs two or more."
            )
        if not 0 <= self.degree <= _HIGHEST:
            raise InputError(f"{self.method}: the degree must be 0 to {_HIGHEST}, but is {self.degree}.")
        refuse_other_than_points(self.method, points.shape[1])
        refuse_few(self.method, points, 2 * _term_count(max(self.degree, 1)))
        refuse_collinear(self.method, points)
        refuse_one_plane(self.method, points)
        seen = pixels.reshape(len(pixels), cameras, 2)
        self.rotation_ = _frame(self.method, seen, points)
        turned = points @ self.rotation_.T
        space, picture = RangeScaling.of(turned), RangeScaling.of(pixels)
        self.centre_, self.half_range_ = space.centre, space.half_range
        self.pixel_centre_, self.pixel_half_range_ = picture.centre, picture.half_range
        scaled, p = picture.scaled(pixels).reshape(seen.shape), space.scaled(turned)
        degrees = [self.degree or _chosen_degree(scaled[:, i], p) for i in range(cameras)]
        self.degrees_ = tuple(degrees)
        self.coefficients_ = np.zeros((cameras, 2 * _term_count(max(degrees)), 2))
        for i, degree in enumerate(degrees):
            found = _solved(scaled[:, i], p, degree).reshape(2, -1, 2)
            both = self.coefficients_[i].reshape(2, -1, 2)
            both[:, : found.shape[1]] = found  # a view: terms are sorted by degree
        self._keep_errors([self._model_error(i, seen[:, i], points) for i in range(cameras)])

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        scaled = RangeScaling(self.pixel_centre_, self.pixel_half_range_).scaled(pixels)
        space = RangeScaling(self.centre_, self.half_range_)
        ends = []
        for depth in (-1.0, 1.0):
            plane = []
            for i in range(len(self.degrees_)):
                terms = _terms(scaled[:, 2 * i : 2 * i + 2], max(self.degrees_))
                xy = np.concatenate([terms, depth * terms], axis=1) @ self.coefficients_[i]
                z = np.full((len(xy), 1), depth)
                plane.append(space.restored(np.concatenate([xy, z], axis=1)) @ self.rotation_)
            ends.append(np.stack(plane, axis=1))
        direction = ends[1] - ends[0]
        direction /= np.linalg.norm(direction, axis=2, keepdims=True)
        return closest_points(ends[0], direction)

    def _sizes(self) -> tuple[int, int]:
        highest = max(self.degrees_)
        return 4 * _term_count(highest), 4 * (highest + 2)

    def _slopes(self, camera: int, q: Pixels, p: Vectors3) -> Slopes:
        terms, lacking, picture = self._linearised(camera, q, p)
        to_pixels = inverses(picture)
        return Slopes(_of_both(terms, to_pixels), _of_both(lacking, to_pixels))

    def _model_error(self, camera: int, q: Pixels, p: Vectors3) -> LinearModelError:
        """Return the error of a camera that was fitted to pixels and points, mm."""
        terms, _, picture = self._linearised(camera, q, p)
        fitted = np.linalg.pinv(terms, rcond=_SINGULAR)
        response = np.einsum("tn,nab->ntab", fitted, picture).reshape(len(q), -1, 2)
        beside = terms @ self._own_coefficients(camera) - self._scaled_points(p)[:, :2]
        residual = np.einsum("nab,nb->na", inverses(picture), beside)
        return LinearModelError.of(residual, response, self._slopes(camera, q, p))

    def _linearised(
        self, camera: int, q: Pixels, p: Vectors3
    ) -> tuple[
        Float64[np.ndarray, "n terms"], Float64[np.ndarray, "n lacking"], Float64[np.ndarray, "n 2 2"]
    ]:
        """Return terms, those of the next degree, and the slopes of a ray's place by its pixel, 1/px."""
        columns, degree = slice(2 * camera, 2 * camera + 2), self.degrees_[camera]
        scaling = RangeScaling(self.pixel_centre_[columns], self.pixel_half_range_[columns])
        u, local, coefficients = scaling.scaled(q), self._scaled_points(p), self._own_coefficients(camera)
        higher = _terms(u, degree + 1)[:, _term_count(degree) :]
        by_pixel = [_design_slope(u, local, degree, axis) @ coefficients for axis in (0, 1)]
        return (
            _design(u, local, degree),
            np.concatenate([higher, local[:, 2:] * higher], axis=1),
            np.stack(by_pixel, axis=2) / scaling.half_range,
        )

    def _own_coefficients(self, camera: int) -> Float64[np.ndarray, "terms 2"]:
        """Return the coefficients of a camera's own degree."""
        own = _term_count(self.degrees_[camera])
        return np.asarray(self.coefficients_[camera].reshape(2, -1, 2)[:, :own].reshape(-1, 2))

    def _scaled_points(self, p: Vectors3) -> Vectors3:
        return RangeScaling(self.centre_, self.half_range_).scaled(p @ self.rotation_.T)


def _of_both(
    terms: Float64[np.ndarray, "n terms"], to_pixels: Float64[np.ndarray, "n 2 2"]
) -> Float64[np.ndarray, "n 2 columns"]:
    """Return the derivatives of pixels by the coefficients of terms in x and y."""
    return np.asarray(terms[:, None, :, None] * to_pixels[:, :, None, :]).reshape(len(terms), 2, -1)


def _frame(method: str, seen: Float64[np.ndarray, "n cameras 2"], p: Vectors3) -> Float64[np.ndarray, "3 3"]:
    """Return the rotation into a frame whose z is the cameras' mean view, by their linear projections."""
    view = np.zeros(3)
    for i in range(seen.shape[1]):
        third = projective_map(method, p, seen[:, i])[2, :3]
        view += third / np.linalg.norm(third)
    z = view / np.linalg.norm(view)
    x = np.cross(np.eye(3)[int(np.argmin(np.abs(z)))], z)
    x /= np.linalg.norm(x)
    return np.stack([x, np.cross(z, x), z])


def _chosen_degree(q: Pixels, p: Vectors3) -> int:
    """Return the degree that predicts held-out edges best; all is scaled."""
    squares = []
    for degree in range(1, _HIGHEST + 1):
        parts = []
        for out in edges(q):
            if (~out).sum() < 2 * _term_count(degree):
                parts.append(np.full(int(out.sum()), np.inf))
                continue
            residual = _design(q[out], p[out], degree) @ _solved(q[~out], p[~out], degree) - p[out, :2]
            parts.append((residual**2).sum(axis=1))
        squares.append(np.concatenate(parts))
    return 1 + int(np.argmin([square.mean() for square in squares]))


def _solved(q: Pixels, p: Vectors3, degree: int) -> Float64[np.ndarray, "terms 2"]:
    return np.asarray(np.linalg.lstsq(_design(q, p, degree), p[:, :2], rcond=_SINGULAR)[0])


def _design(q: Pixels, p: Vectors3, degree: int) -> Float64[np.ndarray, "n terms"]:
    """Return the terms of the middle plane, then those times the depth."""
    terms = _terms(q, degree)
    return np.concatenate([terms, p[:, 2:] * terms], axis=1)


def _terms(q: Pixels, degree: int) -> Float64[np.ndarray, "n terms"]:
    """Return all products of powers of both coordinates, sorted by degree."""
    u, v = q.T
    return np.stack([u ** (d - j) * v**j for d in range(degree + 1) for j in range(d + 1)], axis=1)


def _design_slope(q: Pixels, p: Vectors3, degree: int, axis: int) -> Float64[np.ndarray, "n terms"]:
    """Return the derivative of `_design` by a pixel coordinate."""
    powers = [(d - j, j) for d in range(degree + 1) for j in range(d + 1)]
    columns = []
    for both in powers:
        power, other = both[axis], both[1 - axis]
        columns.append(power * q[:, axis] ** max(power - 1, 0) * q[:, 1 - axis] ** other)
    terms = np.stack(columns, axis=1)
    return np.concatenate([terms, p[:, 2:] * terms], axis=1)


def _term_count(degree: int) -> int:
    """Return the number of terms up to a degree."""
    return (degree + 1) * (degree + 2) // 2
