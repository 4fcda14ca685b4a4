"""The choice of the pose that lowers the error over the volume most."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int

from labcal.arrays import Mask, Pose
from labcal.cameras.camera import Camera
from labcal.guide.next_pose.candidates import HandReach, drawn_poses, nearby_poses
from labcal.guide.next_pose.findable import Findable
from labcal.guide.next_pose.hand import HandError
from labcal.guide.next_pose.information import Variance, view_information
from labcal.guide.next_pose.volume import MeasuredVolume

CANDIDATES, LOOKED_AT = 3000, 500
"""Poses that are drawn, and those of them, where the target is found, that are compared at most."""
BEST, NEARBY = 8, 20
"""Of the best poses so many go on, and so many near each of them are tried."""
SPREADS = (0.15, 0.07, 0.03)
"""Of poses nearby: rad, and shares of the distance."""
_PAIR = 2


def next_pose(
    volume: MeasuredVolume,
    covariance: Float64[np.ndarray, "parameters parameters"],
    target: Findable,
    variance: Variance,
    reach: HandReach,
    random: np.random.Generator,
) -> tuple[Pose, Mask] | None:
    """Return the pose to take next, and a mask of the cameras that will find the target there.

    Of poses that are drawn, those are left at which at least two cameras (the camera, of one) find the
    target; the one is taken that leaves the least mean squared error over the volume, if it is found with
    the errors of a hand, too ("I-optimal" design).

    Parameters
    ----------
    volume : MeasuredVolume
    covariance : ndarray, shape (parameters, parameters)
        Of the rig's parameters so far.
    target : Findable
    variance : callable
    reach : HandReach
    random : Generator

    Returns
    -------
    (ndarray of shape (4, 4), ndarray of bool) or None
        None where no pose was found.
    """
    cameras = volume.cameras
    drawn = drawn_poses(cameras, reach, target.middle, CANDIDATES, random)
    pool = _Pool.of(drawn, cameras, target)
    for spread in (None, *SPREADS):
        if spread is not None:
            best = pool.T_world_target[:BEST]
            near = [nearby_poses(T, target.middle, spread, NEARBY, random) for T in best]
            pool = _Pool.of(np.concatenate([best, *near]), cameras, target)
        if len(pool.T_world_target) == 0:
            return None
        added = view_information(cameras, pool.T_world_target, target, pool.seen, variance)
        left = mean_squares_after(covariance, added, volume.square_by_parameters)
        pool = pool.sure(np.argsort(left, kind="stable"), cameras, target, reach.hand)
    if len(pool.T_world_target) == 0:
        return None
    return pool.T_world_target[0], pool.found[:, 0]


@dataclass(frozen=True)
class _Pool:
    """Poses at which enough cameras find the target."""

    T_world_target: Float64[np.ndarray, "n 4 4"]
    found: Bool[np.ndarray, "cameras n"]
    seen: Bool[np.ndarray, "cameras n dots"]

    @classmethod
    def of(
        cls, drawn: Float64[np.ndarray, "n 4 4"], cameras: tuple[Camera, ...], target: Findable
    ) -> "_Pool":
        found, seen = (
            np.array(part) for part in zip(*(target.seen(one, drawn) for one in cameras), strict=True)
        )
        enough = np.flatnonzero(found.sum(axis=0) >= min(_PAIR, len(cameras)))[:LOOKED_AT]
        return cls(drawn[enough], found[:, enough], (seen & found[..., None])[:, enough])

    def sure(
        self,
        order: Int[np.ndarray, " n"],
        cameras: tuple[Camera, ...],
        target: Findable,
        hand: HandError,
    ) -> "_Pool":
        """Return the first poses of an order at which a hand with its errors is found, too."""
        good: list[int] = []
        for number in order:
            sure = target.sure(cameras, self.T_world_target[number], hand)
            if (sure | ~self.found[:, number]).all():
                good.append(int(number))
            if len(good) == BEST:
                break
        return _Pool(self.T_world_target[good], self.found[:, good], self.seen[:, good])


def mean_squares_after(
    covariance: Float64[np.ndarray, "parameters parameters"],
    added: Float64[np.ndarray, "n parameters parameters"],
    square: Float64[np.ndarray, "parameters parameters"],
) -> Float64[np.ndarray, " n"]:
    """Return tr(M C') for the covariances C' = (C^-1 + S)^-1 after information S was added to C.

    Parameters
    ----------
    covariance : ndarray, shape (parameters, parameters)
        C.
    added : ndarray, shape (n, parameters, parameters)
        S of each choice.
    square : ndarray, shape (parameters, parameters)
        M.
    """
    scale = np.sqrt(np.maximum(np.diagonal(covariance), 1e-300))
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    root = scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0))
    inside = np.eye(len(root)) + root.T @ added @ root
    return np.asarray(np.trace(np.linalg.solve(inside, root.T @ square @ root), axis1=1, axis2=2))
