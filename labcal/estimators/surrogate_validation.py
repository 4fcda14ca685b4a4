"""Surrogate validation of methods: their errors on cameras that the hybrid method estimated."""

import time
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.calibrate.lens_candidates import AUTO
from labcal.cameras.triangulation import covariance_at
from labcal.errors import InputError
from labcal.estimators.bundle import Bundle
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.expected_error import ExpectedError
from labcal.estimators.gp_field.fitted_camera import measured_by
from labcal.estimators.gp_field.stage_moves import StageMoves
from labcal.estimators.hybrid import Hybrid
from labcal.geometry.ellipsoids import within_ellipsoids
from labcal.geometry.hull import inside_hull
from labcal.rng import generator

POINTS = 1000
CONFIDENCE = 0.95
_DRAWN_AT_ONCE = 4 * POINTS
_MOST_DRAWS = 50


@dataclass(frozen=True)
class Surrogate:
    """Points within the training volume, and their noisy pixels in cameras like the real ones.

    Attributes
    ----------
    hybrid : Hybrid
        Fitted to the training data; its cameras see the points.
    p : float64 array, (n, 3)
        Mm.
    X : float64 array, (n, 2 x cameras)
        Px.
    covariance : float64 array, (n, cameras, 2, 2)
        Of the pixels, px squared.
    limit_mm : float
        RMS 3-D error that the noise leaves where cameras are known exactly.
    camera_error : float64 array, (n, 3)
        A draw, by point, of how far the surrogate's cameras are from the real ones by their covariance, mm;
        0 where a camera has a field.
    hybrid_seconds : float
        Duration of the fit of `hybrid`.
    """

    hybrid: Hybrid
    p: Vectors3
    X: Float64[np.ndarray, "n inputs"]
    covariance: Float64[np.ndarray, "n cameras 2 2"]
    limit_mm: float
    camera_error: Vectors3
    hybrid_seconds: float


def surrogate_of(
    X: Float64[np.ndarray, "n inputs"],
    Y: Vectors3,
    image_sizes: tuple[tuple[int, int], ...],
    seed: int = 0,
    lens: str = AUTO,
    moves: StageMoves | None = None,
) -> Surrogate | None:
    """Return a surrogate from training data, or None if they do not determine cameras.

    Parameters
    ----------
    X : ndarray, shape (n, 2 x cameras)
        Px.
    Y : ndarray, shape (n, 3)
        Mm.
    image_sizes : tuple of (int, int)
        Width and height, px, of each camera's pictures.
    seed : int
        Draws points and noise.
    lens : str
        Of `Hybrid`.
    moves : StageMoves, optional
        Stated errors of the stage.

    Notes
    -----
    The cameras are those of `Hybrid`, which follow the data wherever these lead, and the noise is what they
    leave. What a method that sees only the training pixels makes of the points between is then measured
    against a truth, though not against the real one.
    """
    began = time.perf_counter()
    try:
        hybrid = Hybrid(lens, image_sizes).fit_on_stage(X, Y, moves)
    except InputError:
        return None
    hybrid_seconds = time.perf_counter() - began
    cameras = hybrid.fitted_cameras_
    random = generator(seed, "rehearsal")
    p = _points_within(Y, random)
    q = np.stack([camera.project(p) for camera in cameras], axis=1)
    seen = np.isfinite(q).all(axis=(1, 2))
    p, q = p[seen], q[seen]
    if len(p) == 0:
        return None
    noise = np.array([camera.noise_px for camera in cameras])
    covariance = np.tile(noise[:, None, None] ** 2 * np.eye(2), (len(p), 1, 1, 1))
    imagers = measured_by(cameras, q)
    limit = covariance_at(imagers, p, q, covariance)
    own = np.zeros_like(limit)
    if all(camera.fitted is None for camera in cameras):
        with_own = [camera.pixel_covariance(q[:, i], p, covariance[:, i]) for i, camera in enumerate(cameras)]
        own = covariance_at(imagers, p, q, np.stack(with_own, axis=1)) - limit
    q = q + noise[:, None] * random.standard_normal(q.shape)
    limit_mm = float(np.sqrt(np.trace(limit, axis1=1, axis2=2).mean()))
    error = _drawn(own, random)
    return Surrogate(hybrid, p, q.reshape(len(p), -1), covariance, limit_mm, error, hybrid_seconds)


def fit_unless_surrogate(
    surrogate: Surrogate | None,
    estimator: PointEstimator,
    X: Float64[np.ndarray, "n inputs"],
    Y: Vectors3,
    moves: StageMoves | None = None,
) -> PointEstimator:
    """Return a method fitted to the training data of a surrogate.

    What the hybrid method of the surrogate has found is not found again: it is returned itself if the
    estimator has the same parameters, and `bundle` with the same lens takes its resected cameras.

    The covariances of other methods are calibrated on the points of the surrogate, which they have not seen.
    Where a lens formula explains all, the surrogate's own error counts as well: the difference of a method
    from an efficient one is not correlated with the error of the latter (Hausman 1978), so that their
    variances add up. Below a field a method may be the better one, and its difference holds the field's error
    already. Methods with cameras are not calibrated: the surrogate's are made of the same formulas.
    """
    taken = surrogate is not None and takes_from(surrogate, estimator)
    if isinstance(estimator, Hybrid) and not taken:
        return estimator.fit_on_stage(X, Y, moves)
    if surrogate is None:
        return estimator.fit(X, Y)
    if taken and isinstance(estimator, Hybrid):
        return surrogate.hybrid
    if taken and isinstance(estimator, Bundle):
        return estimator.fit_resected(X, Y, surrogate.hybrid.resected_)
    estimator.fit(X, Y)
    if not isinstance(estimator, CameraEstimator):
        estimator.calibrate_covariance(
            surrogate.X, surrogate.covariance, surrogate.p + surrogate.camera_error
        )
    return estimator


def takes_from(surrogate: Surrogate, estimator: PointEstimator) -> bool:
    """Return whether a method takes what the hybrid method of a surrogate has found, for it is the same."""
    known = surrogate.hybrid.get_params()
    if isinstance(estimator, Bundle):
        return bool(estimator.get_params() == Bundle(**known).get_params())
    return isinstance(estimator, Hybrid) and bool(estimator.get_params() == known)


def validate_on(estimator: PointEstimator, surrogate: Surrogate) -> ExpectedError:
    """Return the expected error of a fitted method: its errors on the points of a surrogate."""
    outputs, covariance = estimator.predict_with_covariance(surrogate.X, surrogate.covariance)
    error = outputs[:, :3] - surrogate.p
    square = (error**2).sum(axis=1)
    known = square[np.isfinite(square)]
    rmse = float(np.sqrt(known.mean())) if len(known) else float("nan")
    return ExpectedError(
        rmse, surrogate.limit_mm, float(within_ellipsoids(error, covariance, CONFIDENCE).mean())
    )


def _drawn(
    covariance: Float64[np.ndarray, "n 3 3"], random: np.random.Generator
) -> Float64[np.ndarray, "n 3"]:
    """Return normal errors of covariances, whose variances below zero are rounding; 0 where one is NaN."""
    known = np.isfinite(covariance).all(axis=(1, 2))
    variance, axes = np.linalg.eigh(np.where(known[:, None, None], covariance, 0.0))
    white = random.standard_normal(variance.shape) * np.sqrt(np.maximum(variance, 0.0))
    return np.asarray((axes @ white[:, :, None])[:, :, 0])


def _points_within(Y: Vectors3, random: np.random.Generator) -> Float64[np.ndarray, "drawn 3"]:
    """Return random points in the convex hull of others."""
    low, high = Y.min(axis=0), Y.max(axis=0)
    found: list[np.ndarray] = []
    for _ in range(_MOST_DRAWS):
        drawn = random.uniform(low, high, (_DRAWN_AT_ONCE, 3))
        found.append(drawn[inside_hull(drawn, Y, 0.0)])
        if sum(map(len, found)) >= POINTS:
            break
    return np.concatenate(found)[:POINTS]
