"""The information that a view of the target adds on lenses and poses of a rig."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Bool, Float64

from labcal.cameras.camera import Camera
from labcal.cameras.parameter_derivatives import (
    parameter_count,
    parameter_derivatives,
    parameter_slices,
)
from labcal.geometry.cross_matrices import cross_matrices
from labcal.guide.next_pose.findable import Findable, images

_POSE = 6

Variance = Callable[[Float64[np.ndarray, " n"]], Float64[np.ndarray, " n"]]
"""Variance of a coordinate, px squared, by the minor semi-axis of a dot's image, px."""


def view_information(
    cameras: tuple[Camera, ...],
    T_world_target: Float64[np.ndarray, "n 4 4"],
    target: Findable,
    seen: Bool[np.ndarray, "cameras n dots"],
    variance: Variance,
) -> Float64[np.ndarray, "n parameters parameters"]:
    """Return the information of each view on the rig's parameters, the pose of the target eliminated.

    Parameters
    ----------
    cameras : tuple of Camera
        The first one is the world.
    T_world_target : ndarray, shape (n, 4, 4)
        Mm.
    target : Findable
    seen : ndarray of bool, shape (cameras, n, dots)
        Dots that are measured.
    variance : callable

    Returns
    -------
    ndarray, shape (n, parameters, parameters)
        In the order of ``rig.json``; px, rad, mm.

    Notes
    -----
    The normal equations of one view have the blocks A of shared parameters, B, and D of its pose. What is
    left for the shared ones is the Schur complement A - B D^-1 B' (Triggs et al. 2000, section 6.1).
    """
    n, every = len(T_world_target), target.every
    dots, places = target.dots[target.even], parameter_slices(cameras)
    count = parameter_count(cameras)
    shared = np.zeros((n, count, count))
    mixed, own = np.zeros((n, count, _POSE)), np.zeros((n, _POSE, _POSE))
    p = np.einsum("nij,kj->nki", T_world_target[:, :3, :3], dots) + T_world_target[:, None, :3, 3]
    middle = T_world_target[:, :3, :3] @ target.middle + T_world_target[:, :3, 3]
    turned = -cross_matrices((p - middle[:, None]).reshape(-1, 3)).reshape(n, len(dots), 3, 3)
    for camera, place, of in zip(cameras, places, seen[:, :, target.even], strict=True):
        _, sizes, _ = images(camera, T_world_target, dots, target.radius_mm)
        with np.errstate(all="ignore"):  # of points behind the camera
            found = parameter_derivatives(camera, p.reshape(-1, 3))
            weight = np.where(of, every / variance(np.maximum(sizes.minor_px, 1e-3)), 0.0)
        at = (of & (sizes.minor_px > 0.0)).reshape(-1)
        width = place.stop - place.start
        by_point = np.where(at[:, None, None], found.by_point, 0.0).reshape(n, len(dots), 2, 3)
        by_shared = np.where(at[:, None, None], found.by_parameters[..., :width], 0.0)
        by_pose = np.concatenate([by_point @ turned, by_point], axis=-1).reshape(n, -1, _POSE)
        by_shared = by_shared.reshape(n, -1, width)
        w = np.repeat(weight, 2, axis=1)[..., None]
        shared[:, place, place] += by_shared.transpose(0, 2, 1) @ (w * by_shared)
        mixed[:, place] += by_shared.transpose(0, 2, 1) @ (w * by_pose)
        own += by_pose.transpose(0, 2, 1) @ (w * by_pose)
    scale = 1.0 / np.sqrt(np.maximum(np.diagonal(own, axis1=1, axis2=2), 1e-300))
    own = own * scale[:, :, None] * scale[:, None, :] + 1e-12 * np.eye(_POSE)
    mixed = mixed * scale[:, None, :]
    return np.asarray(shared - mixed @ np.linalg.solve(own, mixed.transpose(0, 2, 1)))
