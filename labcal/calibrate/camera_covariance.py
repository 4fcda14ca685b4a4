"""The covariance of the cameras of a rig, and what it makes of triangulated points."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.rounds import Adjusted
from labcal.calibrate.budget.error_sources import ErrorSources
from labcal.cameras.camera import Camera
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.rigid_part import without_rigid_part


@dataclass(frozen=True)
class CameraCovariance:
    """The joint covariance of all lenses and poses of a rig; the first camera is the world.

    Attributes
    ----------
    covariance : float64 array, (free, free)
        In px, px/unit, rad and mm; NaN where the views leave a parameter open.
    lens, pose : tuple of slice
        By camera: where its intrinsics and coefficients are, and its rotation and shift; empty where fixed.
    """

    covariance: Float64[np.ndarray, "free free"]
    lens: tuple[slice, ...]
    pose: tuple[slice, ...]

    @classmethod
    def of(cls, adjusted: Adjusted, sources: ErrorSources) -> "CameraCovariance":
        """Return that of an adjustment with all sources of errors, without the dots of the print."""
        layout = adjusted.layout
        free = layout.pose[-1].stop
        return cls(sources.total(adjusted.covariance[:free, :free]), layout.lens, layout.pose)

    def rms_mm(self, cameras: Sequence[Camera], p: Float64[np.ndarray, "n 3"]) -> float:
        """Return the RMS error of triangulated points that the cameras' uncertainty causes.

        A motion of the whole is no error: it is removed, as an alignment of points onto a truth does.

        Parameters
        ----------
        cameras : sequence of Camera
            At least two, those of the adjustment.
        p : ndarray, shape (n, 3)
            Places that all cameras see, mm; at least three, not on a line.

        Returns
        -------
        float
            Mm; NaN where the views leave a parameter open that moves points.

        Notes
        -----
        To first order a point moves by -N^-1 sum J^T G d where d is the cameras' error, G the derivatives of
        pixels by the cameras, J those by the point, and N = sum J^T J (all pixels weigh the same).
        """
        n = len(p)
        moved = without_rigid_part(_motions(cameras, p, self), p).reshape(3 * n, -1)
        return float(np.sqrt(np.maximum(0.0, np.einsum("ij,jk,ik->", moved, self.covariance, moved) / n)))


def _motions(
    cameras: Sequence[Camera], p: Float64[np.ndarray, "n 3"], of: CameraCovariance
) -> Float64[np.ndarray, "n 3 free"]:
    """Return the derivatives of triangulated points by the cameras' parameters."""
    normal = np.zeros((len(p), 3, 3))
    gradient = np.zeros((len(p), 3, len(of.covariance)))
    for camera, lens, pose in zip(cameras, of.lens, of.pose, strict=True):
        by_point = camera.point_jacobian(p)
        normal += np.einsum("nki,nkj->nij", by_point, by_point)
        if lens.stop > lens.start:
            gradient[:, :, lens] += np.einsum("nki,nkj->nij", by_point, camera.intrinsic_jacobian(p))
        if pose.stop > pose.start:
            R = camera.T_cam_world[:3, :3]
            by_place = by_point @ R.T
            by_pose = np.concatenate([-by_place @ cross_matrices(p @ R.T), by_place], axis=2)
            gradient[:, :, pose] += np.einsum("nki,nkj->nij", by_point, by_pose)
    return np.asarray(-np.linalg.solve(normal, gradient))
