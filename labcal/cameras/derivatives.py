"""Pixels with their derivatives by the point and by the camera's own numbers, in one pass over all points."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask, Pixels, PointJacobians, Points
from labcal.cameras.camera import Camera, slopes_of
from labcal.cameras.dual import Dual, DualMathematics, constants, variables
from labcal.cameras.mathematics import NUMPY
from labcal.cameras.optics import INTRINSICS

POINT = 3
"""Directions of a point come first; the camera's numbers follow."""


@dataclass(frozen=True)
class ProjectionDerivatives:
    """Where n points are imaged, and how that changes."""

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
    return _derivatives(camera, constants(camera.numbers, POINT), variables(*np.moveaxis(p_cam, -1, 0)))


def _derivatives(camera: Camera, numbers: tuple[Dual, ...], p: tuple[Dual, ...]) -> ProjectionDerivatives:
    with np.errstate(invalid="ignore", over="ignore", divide="ignore"):
        found = camera.optics.project(DualMathematics(NUMPY), numbers, (p[0], p[1], p[2]))
    J = slopes_of(found.u.slopes, found.v.slopes, np.shape(p[0].value))
    q = np.stack([found.u.value, found.v.value], axis=-1)
    return ProjectionDerivatives(q, np.asarray(found.ok), J[..., :POINT], J[..., POINT:])
