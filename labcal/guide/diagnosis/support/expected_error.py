"""The 3-D error to expect after a calibration from views of a target, over all that the cameras see."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels, Pose
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.prior_term import LensPrior
from labcal.calibrate.adjustment.problem import AdjustmentProblem
from labcal.calibrate.adjustment.state import Freedom, Lenses, RigState
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_prior import PriorWidth
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import RigCovariance
from labcal.geometry.poses import transform
from labcal.geometry.rigid_part import without_rigid_part
from labcal.reconstruct.point_budget import Budget, PointBudget

_STEPS = (6, 5, 3)
"""Points of the volume across, along and in depth."""
_BORDER = 0.1
"""Share of the picture that is left out on each side."""

_DEPTH = 0.15
"""By which the volume reaches to both sides of the target's usual distance, at least."""


@dataclass(frozen=True)
class ErrorParts:
    """Mean squared 3-D errors of points, by the noise of their own pixels and by the calibration, mm squared.

    The calibration's part is of shape and size: a rigid motion of all points is no error of a rig whose
    world nobody has given.
    """

    noise_mm2: float
    calibration_mm2: float

    def rms_mm(self, views: float = 1.0) -> float:
        """Return the RMS error after a calibration from so many times as many views of the same kind."""
        return float(np.sqrt(self.noise_mm2 + self.calibration_mm2 / views))


@dataclass(frozen=True)
class SupportedRig:
    """Calibrated cameras and a target, for which views can be supposed.

    Attributes
    ----------
    rig : Rig
    dots : float64 array, (n, 3)
        On the print, mm.
    noise_px : tuple of float
        Standard deviation of a dot along each axis, by camera.
    volume : float64 array, (points, 3)
        Points that all cameras see, at the distances of the target, mm.
    """

    rig: Rig
    dots: Float64[np.ndarray, "dots 3"]
    noise_px: tuple[float, ...]
    volume: Float64[np.ndarray, "points 3"]

    @classmethod
    def of(cls, found: HandheldCalibration) -> "SupportedRig":
        """Return the rig of a calibration."""
        return cls(
            rig=found.rig,
            dots=found.dots,
            noise_px=tuple(found.pixel_sigma_px),
            volume=_seen_volume(_cameras(found.rig), found.places),
        )

    @property
    def cameras(self) -> tuple[Camera, ...]:
        """All cameras in order."""
        return _cameras(self.rig)

    def errors(self, poses: list[Pose]) -> ErrorParts | None:
        """Return the errors to expect after a calibration from views.

        Parameters
        ----------
        poses : list of ndarray, shape (4, 4)
            ``T_world_target``, mm.

        Returns
        -------
        ErrorParts or None
            None where the views do not determine the cameras.
        """
        state = RigState(self.cameras, np.array(poses), self.dots)
        observations = self._observations(poses)
        free = Freedom(Lenses.FREE, np.zeros((self.dots.size, 0)))
        prior = LensPrior.of(state, observations, Lenses.FREE, PriorWidth.WIDE)
        covariance = AdjustmentProblem(observations, free, prior=prior).linearize(state).shared_covariance()
        if not np.isfinite(covariance).all():
            return None
        record = RigCovariance.of(self.rig.cameras, covariance)
        rig = self.rig.model_copy(update={"covariance": record})
        pixels = np.array([sigma**2 * np.eye(2) for sigma in self.noise_px])
        p = self.volume
        budget = PointBudget.of(rig, p, np.tile(pixels, (len(p), 1, 1, 1)), Budget.FULL)
        left = without_rigid_part(budget.derivatives(np.arange(len(p))), p)
        shape = np.einsum("nij,jk,nik->n", left, budget.parameters, left)
        return ErrorParts(float(np.trace(budget.noise, axis1=1, axis2=2).mean()), float(shape.mean()))

    def seen_share(self, T_world_target: Pose) -> float:
        """Return the share of the dots of a view that the camera that sees least of them sees."""
        p = transform(T_world_target, self.dots)
        return min(float(np.mean(camera.in_picture(camera.project(p).q))) for camera in self.cameras)

    def _observations(self, poses: list[Pose]) -> Observations:
        parts: list[tuple[np.ndarray, ...]] = []
        for number, (camera, sigma) in enumerate(zip(self.cameras, self.noise_px, strict=True)):
            for view, T in enumerate(poses):
                q = camera.project(transform(T, self.dots)).q
                dot = np.flatnonzero(camera.in_picture(q))
                of = np.full(len(dot), number, dtype=np.int64), np.full(len(dot), view, dtype=np.int64)
                parts.append((*of, dot, q[dot], np.tile(sigma**2 * np.eye(2), (len(dot), 1, 1))))
        return Observations(*(np.concatenate(column) for column in zip(*parts, strict=True)))


def _cameras(rig: Rig) -> tuple[Camera, ...]:
    return tuple(rig.camera(name) for name in rig.cameras)


def _seen_volume(
    cameras: tuple[Camera, ...], places: Float64[np.ndarray, "places 3"]
) -> Float64[np.ndarray, "points 3"]:
    """Return points on a grid of the first picture, at distances of the target, that all cameras see."""
    first = cameras[0]
    low, median, high = np.quantile(
        places @ first.T_cam_world[2, :3] + first.T_cam_world[2, 3], [0.1, 0.5, 0.9]
    )
    depths = min(low, (1.0 - _DEPTH) * median), max(high, (1.0 + _DEPTH) * median)
    width, height = first.size
    u, v = (
        np.linspace(_BORDER * size, (1.0 - _BORDER) * size, count)
        for size, count in zip((width, height), _STEPS[:2], strict=True)
    )
    q = np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 2)
    rays = first.rays(q)
    points = np.concatenate(
        [rays.origin + rays.direction * (z / (rays.direction @ first.T_cam_world[2, :3]))[:, None]
         for z in np.linspace(*depths, _STEPS[2])]
    )  # fmt: skip
    seen = [_inside(camera, camera.project(points).q) for camera in cameras]
    kept = points[np.all(seen, axis=0) & np.isfinite(points).all(axis=1)]
    return np.asarray(kept if len(kept) else places)


def _inside(camera: Camera, q: Pixels) -> Mask:
    """Return a mask of pixels that are in the inner part of the picture."""
    share = (q + 0.5) / np.array(camera.size)
    with np.errstate(invalid="ignore"):
        return np.asarray(((share > 0.9 * _BORDER) & (share < 1.0 - 0.9 * _BORDER)).all(axis=1))
