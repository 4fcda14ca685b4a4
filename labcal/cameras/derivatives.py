"""Pixels with their derivatives by the point and by the camera's own parameters, in one pass over all points.

Whoever has many points hands over some :data:`RUN` at a time: arrays that stay in the processor's cache are
several times faster.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels, PointJacobians, Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.jacobians import dual_parameters
from labcal.cameras.mathematics import NUMPY, Number
from labcal.cameras.optics import INTRINSICS
from labcal.geometry.poses import transform

RUN = 4096
"""Points that outweigh the time NumPy takes for a call, and that the processor still has at hand."""
POINT = 3
"""Directions of a point come first; the camera's parameters follow."""
FIELD = 2
"""Directions of a field point."""


@dataclass(frozen=True)
class ProjectionDerivatives:
    """Images of n points, and their derivatives; in memory, points run fastest."""

    q: Pixels
    """(n, 2), px; the lens formula's value even beyond the lens's fold."""
    ok: Mask
    """(n,), whether the camera images the point."""
    by_point: PointJacobians
    """(n, 2, 3), by the point in the camera's frame, px/mm."""
    by_camera: Float64[np.ndarray, "n 2 free"]
    """(n, 2, 4 + coefficients), by fx fy cx cy and the lens's coefficients; or none of them."""


@dataclass(frozen=True)
class Imaged:
    """Images of world points, and their derivatives; NaN for points that are not imaged."""

    q: Pixels
    """(n, 2), px."""
    by_point: PointJacobians
    """(n, 2, 3), px/mm."""


def imaged(camera: Camera, p: Vectors3) -> Imaged:
    """Return images of world points, mm, shape (n, 3)."""
    found = point_derivatives(camera, transform(camera.T_cam_world, p))
    seen = found.ok[:, None]
    by_point = found.by_point @ camera.T_cam_world[:3, :3]
    return Imaged(np.where(seen, found.q, np.nan), np.where(seen[..., None], by_point, np.nan))


def projection_derivatives(camera: Camera, p_cam: Vectors3) -> ProjectionDerivatives:
    """Return images of points of the camera's frame with all derivatives.

    Parameters
    ----------
    camera : Camera
        Any but one with a lens prescription has coefficients to differentiate by.
    p_cam : ndarray, shape (n, 3)
        Points in the camera's frame, mm.

    Notes
    -----
    Dual numbers carry the derivatives (:mod:`labcal.cameras.dual`). One pass costs about as much as the
    derivatives by the camera alone, since both share the lens formula.
    """
    free = camera.model.coefficients
    m, dist, width = DualMathematics(NUMPY), camera.padded_dist, POINT + INTRINSICS + free
    if has_field(camera):
        directions = FIELD + free
        coefficients = _varied(dist, free)
        rest = constants(camera.forward_parameters, directions)
        formula = camera.model.formula(m, coefficients)
        return _through_field(camera, p_cam, (*formula, *rest[INTRINSICS + len(formula) :]), width)
    varied = variables(*np.moveaxis(p_cam, -1, 0), *camera.intrinsics, *dist[:free])
    intrinsics, coefficients = varied[POINT : POINT + INTRINSICS], varied[POINT + INTRINSICS :]
    lens = (*coefficients, *constants(dist[free:], width))
    return _at_once(camera, dual_parameters(camera, m, intrinsics, lens), varied[:POINT])


def point_derivatives(camera: Camera, p_cam: Vectors3) -> ProjectionDerivatives:
    """Return the same with no derivatives by the camera, which costs a fraction.

    Parameters
    ----------
    camera : Camera
    p_cam : ndarray, shape (n, 3)
        Points in the camera's frame, mm.
    """
    if has_field(camera):
        return _through_field(camera, p_cam, camera.forward_parameters[INTRINSICS:], POINT)
    parameters = constants(camera.forward_parameters, POINT)
    return _at_once(camera, parameters, variables(*np.moveaxis(p_cam, -1, 0)))


def has_field(camera: Camera) -> bool:
    """Tell whether points have their field point by a closed formula, with no glass on the way."""
    return camera.optics.closed and camera.window is None


def _varied(dist: tuple[float, ...], free: int) -> tuple[Dual, ...]:
    """Return coefficients of which the first ones vary, along directions after those of the field."""
    directions = FIELD + free
    slopes = [tuple(float(i == FIELD + k) for i in range(directions)) for k in range(len(dist))]
    return tuple(Dual(value, slope) for value, slope in zip(dist, slopes, strict=True))


def _through_field(
    camera: Camera, p_cam: Vectors3, lens: tuple[Number, ...], width: int
) -> ProjectionDerivatives:
    """Return derivatives by the chain rule from the point to its field point and on to the pixel.

    Two directions of the field in the place of three of the point, and none for the intrinsics, leave the
    lens formula half as much to carry. `lens` are its parameters, varying along the two and its coefficients.
    """
    fx, fy, cx, cy = camera.intrinsics
    m, plain = DualMathematics(NUMPY), camera.forward_parameters[INTRINSICS:]
    J = np.zeros((width, 2, len(p_cam)))
    q = np.empty(J.shape[1:])
    more = (0.0,) * (width - POINT - INTRINSICS)
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        X, Y, Z = variables(*np.moveaxis(p_cam, -1, 0))
        field = camera.model.field_point(m, plain, (X, Y, Z))
        a, b = Dual(field.a.value, (1.0, 0.0, *more)), Dual(field.b.value, (0.0, 1.0, *more))
        for axis, at, (f, c) in zip(
            (0, 1), camera.model.distort(m, lens, a, b), ((fx, cx), (fy, cy)), strict=True
        ):
            q[axis] = f * at.value + c
            by_a, by_b = f * at.slopes[0], f * at.slopes[1]
            for row, da, db in zip(J[:POINT, axis], field.a.slopes, field.b.slopes, strict=True):
                row[...] = by_a * da + by_b * db
            if width > POINT:
                J[POINT + axis, axis], J[POINT + FIELD + axis, axis] = at.value, 1.0
            for row, slope in zip(J[POINT + INTRINSICS :, axis], at.slopes[FIELD:], strict=True):
                row[...] = f * slope
    return ProjectionDerivatives(q.T, np.asarray(field.ok), J[:POINT].T, J[POINT:].T)


def _at_once(camera: Camera, parameters: tuple[Dual, ...], p: tuple[Dual, ...]) -> ProjectionDerivatives:
    """Return derivatives with all directions carried all the way."""
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        found = camera.optics.project(DualMathematics(NUMPY), parameters, (p[0], p[1], p[2]))
    J = np.empty((len(found.u.slopes), 2, len(p[0].value)))
    for row, of_u, of_v in zip(J, found.u.slopes, found.v.slopes, strict=True):
        row[0], row[1] = of_u, of_v
    q = np.empty(J.shape[1:])
    q[0], q[1] = found.u.value, found.v.value
    return ProjectionDerivatives(q.T, np.asarray(found.ok), J[:POINT].T, J[POINT:].T)
