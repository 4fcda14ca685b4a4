"""Derivatives of pixels by world points and by a camera's own parameters, for any shape of points."""

from typing import TYPE_CHECKING

import numpy as np

from labcal.arrays import PointJacobians, Vectors3
from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.mathematics import NUMPY, Number
from labcal.cameras.optics import INTRINSICS
from labcal.geometry.poses import transform

if TYPE_CHECKING:
    from labcal.cameras.camera import Camera


def point_jacobian(camera: "Camera", p: Vectors3) -> PointJacobians:
    """Return dq / dp at world points, shape (..., 2, 3), px/mm."""
    X, Y, Z = np.moveaxis(transform(camera.T_cam_world, p), -1, 0)
    parameters = constants(camera.forward_parameters, 3)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        x, y, z = variables(X, Y, Z)
        found = camera.optics.project(DualMathematics(NUMPY), parameters, (x, y, z))
    local = slopes_of(found.u.slopes, found.v.slopes, np.shape(X))
    jacobian: np.ndarray = local @ camera.T_cam_world[:3, :3]
    return jacobian


def intrinsic_jacobian(camera: "Camera", p: Vectors3) -> np.ndarray:
    """Return dq / d(fx, fy, cx, cy, coefficients) at world points, shape (..., 2, 4 + coefficients)."""
    free = camera.model.coefficients
    X, Y, Z = np.moveaxis(transform(camera.T_cam_world, p), -1, 0)
    varied = variables(*camera.intrinsics, *camera.padded_dist[:free])
    directions = INTRINSICS + free
    fixed = constants(camera.padded_dist[free:], directions)
    m = DualMathematics(NUMPY)
    parameters = dual_parameters(camera, m, varied[:INTRINSICS], (*varied[INTRINSICS:], *fixed))
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        x, y, z = constants((X, Y, Z), directions)
        found = camera.optics.project(m, parameters, (x, y, z))
    return slopes_of(found.u.slopes, found.v.slopes, np.shape(X))


def dual_parameters(
    camera: "Camera", m: DualMathematics, intrinsics: tuple[Dual, ...], dist: tuple[Dual, ...]
) -> tuple[Dual, ...]:
    """Return ``forward_parameters`` for derivatives by intrinsics and all of ``padded_dist``."""
    directions = len(intrinsics[0].slopes)
    lens_at = camera.optics.lens_at
    formula = camera.model.formula(m, dist) if camera.model.coefficients else ()
    window = constants(camera.forward_parameters[INTRINSICS:lens_at], directions)
    rest = constants(camera.forward_parameters[lens_at + len(formula) :], directions)
    return (*intrinsics, *window, *formula, *rest)


def slopes_of(of_u: tuple[Number, ...], of_v: tuple[Number, ...], shape: tuple[int, ...]) -> np.ndarray:
    """Return the slopes of both coordinates as one array, shape (..., 2, directions)."""
    rows = [np.stack([np.broadcast_to(slope, shape) for slope in of], axis=-1) for of in (of_u, of_v)]
    return np.stack(rows, axis=-2)
