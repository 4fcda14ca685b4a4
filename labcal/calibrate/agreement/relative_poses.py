"""Relative poses of two cameras by each view alone, with covariances."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64
from scipy.spatial.transform import Rotation

from labcal.arrays import Pose
from labcal.calibrate.adjustment.schur import Reduced
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.rig_start import SharedViews, pose_between
from labcal.calibrate.single_calibration import SingleCalibration


@dataclass(frozen=True)
class SinglePoses:
    """Errors of the target poses of a single-camera calibration, linearised at its result.

    A pose's error is its own, which is independent of all others, plus what an error of the lens (and of the
    dots, where these were free) makes of it, which all views share.
    """

    own: Float64[np.ndarray, "views 6 6"]
    """Covariance of the own error."""
    by_shared: Float64[np.ndarray, "views 6 shared"]
    """Derivatives by what is shared."""
    shared: Float64[np.ndarray, "shared shared"]
    """Inverse covariance of what is shared."""

    @classmethod
    def of(cls, alone: SingleCalibration) -> "SinglePoses | None":
        """Return it, in the scaled units of the Schur complement; None where dots do not fix a pose."""
        reduced = Reduced.of(alone.result.adjusted.normal)
        if reduced is None:
            return None
        back = reduced.inverse_root.transpose(0, 2, 1)
        return cls(back @ reduced.inverse_root, -(back @ reduced.reach) / reduced.scale, reduced.matrix)


@dataclass(frozen=True)
class RelativePoses:
    """Differences of ``T_second_first`` from that of most views, by view, in rad and mm."""

    views: Int64[np.ndarray, " n"]
    """Numbers of the views in the rig."""
    T_second_first: Pose
    """Pose in most views."""
    difference: Float64[np.ndarray, "n 6"]
    """A rotation vector, applied after that pose's rotation, and a shift."""
    own: Float64[np.ndarray, "n 6 6"]
    """Covariance of what is a view's own."""
    by_shared: Float64[np.ndarray, "n 6 shared"]
    shared: Float64[np.ndarray, "shared shared"]
    """Inverse covariance of what both cameras' views share: their lenses."""

    @classmethod
    def of(cls, first: SingleCalibration, second: SingleCalibration) -> "RelativePoses | None":
        """Return those of the views that two cameras share; None where there is none or one is open."""
        poses = SinglePoses.of(first), SinglePoses.of(second)
        views, here, there = np.intersect1d(first.single.views, second.single.views, return_indices=True)
        if poses[0] is None or poses[1] is None or len(views) == 0:
            return None
        usual = pose_between(SharedViews.of(first.single, second.single))
        T_first, T_second = first.single.T_cam_target[here], second.single.T_cam_target[there]
        R = T_second[:, :3, :3] @ T_first[:, :3, :3].transpose(0, 2, 1)
        carried = np.einsum("nij,nj->ni", R, T_first[:, :3, 3])
        turn = Rotation.from_matrix(R @ usual[:3, :3].T).as_rotvec()
        shift = T_second[:, :3, 3] - carried - usual[:3, 3]
        by_first, by_second = _by_pose(R, carried)
        own = by_first @ poses[0].own[here] @ by_first.transpose(0, 2, 1)
        own += by_second @ poses[1].own[there] @ by_second.transpose(0, 2, 1)
        by_shared = [by_first @ poses[0].by_shared[here], by_second @ poses[1].by_shared[there]]
        width = len(poses[0].shared)
        shared = np.zeros((width + len(poses[1].shared),) * 2)
        shared[:width, :width], shared[width:, width:] = poses[0].shared, poses[1].shared
        difference = np.concatenate([turn, shift], axis=1)
        return cls(views, usual, difference, own, np.concatenate(by_shared, axis=2), shared)


def _by_pose(
    R: Float64[np.ndarray, "n 3 3"], carried: Float64[np.ndarray, "n 3"]
) -> tuple[Float64[np.ndarray, "n 6 6"], Float64[np.ndarray, "n 6 6"]]:
    """Return the derivatives of the relative pose by the poses of the target in both cameras.

    Parameters
    ----------
    R : ndarray, shape (n, 3, 3)
        Rotation from the first camera to the second.
    carried : ndarray, shape (n, 3)
        The target's origin in the first camera, turned by it, mm.
    """
    x, y, z = carried.T
    o = np.zeros_like(x)
    cross = np.array([[o, -z, y], [z, o, -x], [-y, x, o]]).transpose(2, 0, 1)
    by_first, by_second = np.zeros((len(R), POSE, POSE)), np.zeros((len(R), POSE, POSE))
    by_first[:, :3, :3] = by_first[:, 3:, 3:] = -R
    by_first[:, 3:, :3] = -cross @ R
    by_second[:, :3, :3] = by_second[:, 3:, 3:] = np.eye(3)
    by_second[:, 3:, :3] = cross
    return by_first, by_second
