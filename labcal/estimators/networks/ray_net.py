"""A network per camera from pixels to rays, and points where the rays meet."""

from typing import ClassVar

import numpy as np
import torch
from jaxtyping import Float64
from scipy.linalg import solve_triangular

from labcal.arrays import Vectors3
from labcal.errors import InputError
from labcal.estimators.estimator import FittedArray, PointEstimator
from labcal.estimators.networks.network_estimator import joint_reason
from labcal.estimators.networks.ray_problem import RayProblem
from labcal.estimators.propagation import propagated_covariances
from labcal.estimators.ray_field import Crossings, RayFrame
from labcal.estimators.scaling import RangeScaling
from labcal.geometry.arrangement import (
    camera_count,
    refuse_collinear,
    refuse_few,
    refuse_one_pixel,
    refuse_one_plane,
    refuse_other_than_points,
)
from labcal.geometry.rays import closest_points
from labcal.optim.bayesian_training import train_by_evidence
from labcal.optim.damping import Damping
from labcal.optim.levenberg_marquardt import minimize_batch
from labcal.optim.network import Network
from labcal.optim.nguyen_widrow import nguyen_widrow
from labcal.optim.penalised_squares import Decayed
from labcal.optim.stopping import Stopping
from labcal.optim.successive_halving import SuccessiveHalving
from labcal.rng import generator
from labcal.run.threads import one_blas_thread, one_torch_thread

CAMERAS, UNKNOWN_POINTS = 2, 6
ROUGH_EPOCHS = 60
"""Of a first training without decay, after which the networks themselves tell what a miss is in pixels.

Where the evidence rules from the start, it may take the waves of a window for noise and never learn them;
where it comes in after this, noise that was learned by then may stay. Both are done, and that of the less
error to expect of new data is kept.
"""
FIRST_MILESTONE = 20
"""Epochs until starts are compared; sooner, one that will not learn the waves looks like the others."""
STEPS = 4
"""Gauss-Newton steps from where the rays come nearest to each other."""


class RayNet(PointEstimator):
    """The method ``ray-net``: volumes only, two cameras or more, any optics with a ray for each pixel.

    Each camera has a network from a pixel to the points where its ray meets two planes across its view, one
    at each end of the trained volume. It is trained by Levenberg-Marquardt with Bayesian regularisation
    (Foresee and Hagan 1997) on the distances of the known points from their rays, in pixels. A point is where
    the distances of all cameras' rays, in pixels, are least in squares. Two planes for a ray: Martins,
    Birk and Kelley 1981.

    The covariance of a point comes from the noise of its pixels and from the weights' uncertainty, which is
    propagated through as if it were noise of pixels, too.

    Parameters
    ----------
    hidden : tuple of int
        Neurons of every hidden layer.
    max_epochs : int
        Accepted steps after which to stop.
    restarts : int
        Starts of the first training that are tried for each camera; the best is kept (see
        `SuccessiveHalving`).
    random_state : int
        Seed of the first weights; the same seed and data give the same bytes.

    Attributes
    ----------
    parameters_ : float64 array, (cameras, parameters)
        All weights and biases, ordered as in `Network`.
    weight_factors_ : float64 array, (cameras, parameters, parameters)
        Lower Cholesky factors of beta J'J + alpha I; the weights' covariance is half of its inverse.
    axes_, origins_, depths_, half_ranges_ : float64 array, a line a camera
        The frames; see `RayFrame`.
    input_centre_, input_half_range_ : float64 array, (inputs,)
        The scaling of the pixels.
    n_iter_ : int
        Epochs of the camera that took most.
    stop_reason_ : str
        Why training stopped; where cameras differ, all of their reasons.
    effective_parameters_ : float
        How many parameters the data determine, the mean over the cameras.
    rms_px_ : float
        Root mean square of the trained points' distances from their rays.
    """

    method: ClassVar[str] = "ray-net"
    fitted_facts: ClassVar[tuple[str, ...]] = (
        "n_iter_", "stop_reason_", "effective_parameters_", "rms_px_",
    )  # fmt: skip

    def __init__(
        self,
        hidden: tuple[int, ...] = (12, 12),
        max_epochs: int = 500,
        restarts: int = 4,
        random_state: int = 0,
    ) -> None:
        self.hidden = hidden
        self.max_epochs = max_epochs
        self.restarts = restarts
        self.random_state = random_state

    def fitted_arrays(self) -> tuple[FittedArray, ...]:
        """Return the arrays that make up the fitted estimator."""
        cameras, count = self.n_features_in_ // 2, self._network().parameter_count
        return (
            FittedArray("parameters_", (cameras, count)),
            FittedArray("weight_factors_", (cameras, count, count)),
            FittedArray("axes_", (cameras, 3, 3)),
            FittedArray("origins_", (cameras, 3)),
            FittedArray("depths_", (cameras, 2)),
            FittedArray("half_ranges_", (cameras,)),
            FittedArray("input_centre_", (self.n_features_in_,)),
            FittedArray("input_half_range_", (self.n_features_in_,)),
        )

    def _fit(self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]) -> None:
        self._refuse(pixels, points)
        scaling = RangeScaling.of(pixels)
        self.input_centre_, self.input_half_range_ = scaling.centre, scaling.half_range
        seen = pixels.reshape(len(pixels), -1, 2)
        frames = [RayFrame.of(points, q) for q in seen.swapaxes(0, 1)]
        self.axes_ = np.stack([frame.axes for frame in frames])
        self.origins_ = np.stack([frame.origin_mm for frame in frames])
        self.depths_ = np.stack([frame.depths_mm for frame in frames])
        self.half_ranges_ = np.array([frame.half_range_mm for frame in frames])
        scales = np.stack(
            [frame.first_scale(points, q) for frame, q in zip(frames, seen.swapaxes(0, 1), strict=True)]
        )
        starts = self._starts(len(frames))
        of_cameras = [range(k, len(starts), len(frames)) for k in range(len(frames))]
        halving = SuccessiveHalving(of_cameras, first_milestone=FIRST_MILESTONE)
        with one_torch_thread(), one_blas_thread():
            without_decay = Decayed(self._problem(pixels, points, scales), [0.0] * len(starts))
            stopping = Stopping(max_epochs=min(ROUGH_EPOCHS, self.max_epochs))
            rough = minimize_batch(without_decay, starts, stopping, Damping(), halving)
            self.parameters_ = np.stack([solution.parameters.numpy() for solution in rough])
            scales = np.stack([self._pixels_per_mm(k, pixels, points) for k in range(len(frames))])
            problem = self._problem(pixels, points, scales)
            ruled, corrected = (
                train_by_evidence(problem, first, self.max_epochs, Damping())
                for first in (starts[: len(frames)], [solution.parameters for solution in rough])
            )
        solutions = [
            min(pair, key=lambda one: one.evidence.expected_square(problem.residual_count))
            for pair in zip(ruled, corrected, strict=True)
        ]
        self.parameters_ = np.stack([solution.parameters.numpy() for solution in solutions])
        self.weight_factors_ = np.stack([solution.factor for solution in solutions])
        self.n_iter_ = max(solution.epochs for solution in solutions)
        self.stop_reason_ = joint_reason([str(solution.reason) for solution in solutions])
        effective = [solution.evidence.effective_parameters for solution in solutions]
        self.effective_parameters_ = float(np.mean(effective))
        # Two residuals a point.
        self.rms_px_ = float(np.sqrt(2.0 * np.mean([solution.history[-1] for solution in solutions])))

    def _starts(self, cameras: int) -> list[Float64[torch.Tensor, " p"]]:
        """Return first weights: of every camera once, of every camera again, and so on."""
        # The first starts are named as they were before there were others.
        names = [
            (str(camera), *([str(number)] if number else []))
            for number in range(self.restarts)
            for camera in range(cameras)
        ]
        return [
            nguyen_widrow(self._network(), generator(self.random_state, self.method, "start", *name))
            for name in names
        ]

    def _problem(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        points: Vectors3,
        scales: Float64[np.ndarray, "cameras n 2 2"],
    ) -> RayProblem:
        """Return the problem of all cameras, with pixels per mm at every point."""
        frames = self._frames()
        slopes = [frame.distance_slopes_by_crossing(points) for frame in frames]
        places = [frame.local(points)[:, :2, None] for frame in frames]
        return RayProblem(
            self._network(),
            torch.stack([self._scaled(k, pixels) for k in range(len(frames))]),
            scales @ np.stack(slopes),
            (scales @ np.stack(places))[..., 0],
            self.restarts,
        )

    def _predict(self, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[np.ndarray, "n outputs"]:
        frames = self._frames()
        with one_torch_thread():
            crossings = [self._crossings(k, pixels) for k in range(len(frames))]
            ends = [frame.ends(own) for frame, own in zip(frames, crossings, strict=True)]
            near = np.stack([near for near, _ in ends], axis=1)
            along = np.stack([far - near for near, far in ends], axis=1)
            p = closest_points(near, along / np.linalg.norm(along, axis=2, keepdims=True))
            for _ in range(STEPS):
                normal, gradient = np.zeros((len(p), 3, 3)), np.zeros((len(p), 3))
                for k, (frame, own) in enumerate(zip(frames, crossings, strict=True)):
                    scale = self._pixels_per_mm(k, pixels, p)
                    slopes = scale @ frame.distance_slopes(own)
                    distances = scale @ frame.distances(own, p)[:, :, None]
                    normal += slopes.mT @ slopes
                    gradient += (slopes.mT @ distances)[:, :, 0]
                p = p - np.linalg.solve(normal, gradient[:, :, None])[:, :, 0]
        return np.asarray(p)

    def _covariance_parts(
        self,
        pixels: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n dim dim"], Float64[np.ndarray, "n dim dim"]]:
        points = self._predict(pixels)
        of_weights = np.empty_like(pixel_covariance)
        with one_torch_thread(), one_blas_thread():
            for k, frame in enumerate(self._frames()):
                weights = torch.from_numpy(self.parameters_[k])
                jacobian = self._network().jacobian(weights, self._scaled(k, pixels)).numpy()
                slopes = self._pixels_per_mm(k, pixels, points) @ frame.distance_slopes_by_crossing(points)
                in_pixels = slopes @ jacobian
                flat = in_pixels.reshape(-1, jacobian.shape[2])
                whitened = solve_triangular(self.weight_factors_[k], flat.T, lower=True).T
                whitened = whitened.reshape(in_pixels.shape)
                of_weights[:, k] = 0.5 * whitened @ whitened.mT
        noise, own = propagated_covariances(self._predict, pixels, pixel_covariance, of_weights)
        return noise, own

    def _crossings(self, camera: int, pixels: Float64[np.ndarray, "n inputs"]) -> Crossings:
        """Return where the rays of a camera's pixels meet its planes, scaled."""
        weights = torch.from_numpy(self.parameters_[camera])
        return self._network().forward(weights, self._scaled(camera, pixels))[1].numpy()

    def _pixels_per_mm(
        self, camera: int, pixels: Float64[np.ndarray, "n inputs"], p: Vectors3
    ) -> Float64[np.ndarray, "n 2 2"]:
        """Return the pixels of a distance at each point: the inverse of how its ray moves with the pixel."""
        weights = torch.from_numpy(self.parameters_[camera])
        slopes = self._network().input_jacobian(weights, self._scaled(camera, pixels)).numpy()
        slopes = slopes / self.input_half_range_[2 * camera : 2 * camera + 2]
        return np.asarray(np.linalg.inv(self._frames()[camera].distance_slopes_by_crossing(p) @ slopes))

    def _scaled(self, camera: int, pixels: Float64[np.ndarray, "n inputs"]) -> Float64[torch.Tensor, "n 2"]:
        """Return a camera's pixels as its network takes them."""
        scaled = RangeScaling(self.input_centre_, self.input_half_range_).scaled(pixels)
        return torch.from_numpy(np.ascontiguousarray(scaled[:, 2 * camera : 2 * camera + 2]))

    def _frames(self) -> list[RayFrame]:
        """Return the frame of every camera."""
        parts = zip(self.axes_, self.origins_, self.depths_, self.half_ranges_, strict=True)
        return [RayFrame(axes, origin, depths, float(half)) for axes, origin, depths, half in parts]

    def _network(self) -> Network:
        """Return the shape of each camera's network."""
        return Network((2, *self.hidden, 4))

    def _refuse(
        self, pixels: Float64[np.ndarray, "n inputs"], points: Float64[np.ndarray, "n outputs"]
    ) -> None:
        """Raise where constructor arguments or data cannot be used."""
        if self.max_epochs < 0 or self.random_state < 0 or not self.hidden:
            raise InputError(
                f"{self.method}: max_epochs and random_state must not be negative and hidden not empty, but "
                f"they are {self.max_epochs}, {self.random_state} and {self.hidden}."
            )
        if self.restarts < 1:
            raise InputError(f"{self.method}: restarts must be 1 or more, but is {self.restarts}.")
        if camera_count(self.method, pixels.shape[1]) < CAMERAS:
            raise InputError(f"{self.method}: X has the columns of one camera, but rays meet from two on.")
        refuse_other_than_points(self.method, points.shape[1])
        refuse_few(self.method, points, UNKNOWN_POINTS)
        refuse_collinear(self.method, points)
        refuse_one_plane(self.method, points)
        for q in pixels.reshape(len(pixels), -1, 2).swapaxes(0, 1):
            refuse_one_pixel(self.method, q)
