"""Pixels with their derivatives by the point and by the camera's own numbers, in one pass over all points.

Whoever has many points hands over some :data:`RUN` at a time: arrays that stay in the processor's cache are
several times faster.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels, PointJacobians, Points
from labcal.cameras.camera import Camera
from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.mathematics import NUMPY
from labcal.cameras.optics import INTRINSICS

RUN = 4096
"""Points that outweigh the time NumPy takes for a call, and whose numbers the processor still has at hand."""
POINT = 3
"""Directions of a point come first; the camera's numbers follow."""


@dataclass(frozen=True)
class ProjectionDerivatives:
    """Where n points are imaged, and how that changes; in memory, points run fastest."""

    q: Pixels
    """(n, 2), px; the lens formula's value even beyond the lens's fold."""
    ok: Mask
    """(n,), whether the camera images the point."""
    by_point: PointJacobians
    """(n, 2, 3), by the point in the camera's frame, px/mm."""
    by_camera: Float64[np.ndarray, "n 2 free"]
    """(n, 2, 4 + coefficients), by fx fy cx cy and the lens's coefficients; or none of them."""


def projection_derivatives(camera: Camera, p_cam: Points) -> ProjectionDerivatives:
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
    directions = POINT + INTRINSICS + free
    dist = camera.padded_dist
    varied = variables(*np.moveaxis(p_cam, -1, 0), *camera.intrinsics, *dist[:free])
    p, intrinsics, coefficients = (
        varied[:POINT],
        varied[POINT : directions - free],
        varied[directions - free :],
    )
    m = DualMathematics(NUMPY)
    lens = (*coefficients, *constants(dist[free:], directions))
    return _derivatives(camera, camera.dual_numbers(m, intrinsics, lens), p)


def point_derivatives(camera: Camera, p_cam: Points) -> ProjectionDerivatives:
    """Return the same with no derivatives by the camera, which costs a fraction.

    Parameters
    ----------
    camera : Camera
    p_cam : ndarray, shape (n, 3)
        Points in the camera's frame, mm.
    """
    return _derivatives(camera, constants(camera.forward_numbers, POINT), variables(*np.moveaxis(p_cam, -1, 0)))


def _derivatives(camera: Camera, numbers: tuple[Dual, ...], p: tuple[Dual, ...]) -> ProjectionDerivatives:
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        found = camera.optics.project(DualMathematics(NUMPY), numbers, (p[0], p[1], p[2]))
    count = len(p[0].value)
    J = np.empty((len(found.u.slopes), 2, count))
    for row, of_u, of_v in zip(J, found.u.slopes, found.v.slopes, strict=True):
        row[0], row[1] = of_u, of_v
    q = np.empty((2, count))
    q[0], q[1] = found.u.value, found.v.value
    return ProjectionDerivatives(q.T, np.asarray(found.ok), J[:POINT].T, J[POINT:].T)
