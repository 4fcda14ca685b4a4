"""The parts of triangulation residuals that no choice of points changes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.parameter_derivatives import parameter_count, parameter_derivatives, parameter_slices
from labcal.correspond.matching import Matches


@dataclass(frozen=True)
class ResidualParts:
    """Parts of the residuals r of points that the same c cameras see, and their origins.

    Let J (2 c x 3) be the derivatives of a point's pixels by the point, and N an orthonormal basis of the
    left null space of J. N'r does not depend on the point.

    Attributes
    ----------
    null : float64 array, (n, 2 c - 3, 2 c)
        N', by point.
    seen : float64 array, (n, 2 c - 3)
        N'r, px.
    noise : float64 array, (n, 2 c - 3, 2 c - 3)
        Their covariance by the pixels' noise, px squared.
    by_cameras : float64 array, (n, 2 c - 3, parameters)
        Their derivatives by the parameters of all cameras, in the order of ``rig.json``.
    q : float64 array, (n, c, 2)
        Images of the points by the cameras, px.
    """

    null: Float64[np.ndarray, "n k pixels"]
    seen: Float64[np.ndarray, "n k"]
    noise: Float64[np.ndarray, "n k k"]
    by_cameras: Float64[np.ndarray, "n k parameters"]
    q: Float64[np.ndarray, "n cameras 2"]

    @classmethod
    def of(
        cls,
        cameras: Sequence[Camera],
        chosen: Sequence[int],
        matches: Matches,
        point: Vectors3,
        scatter_px: float,
    ) -> "ResidualParts":
        """Return the parts of the residuals of triangulated points.

        Parameters
        ----------
        cameras : sequence of Camera
            All of the rig; the first one is the world.
        chosen : sequence of int
            Numbers of the cameras that see the points, in the order of the matches.
        matches : Matches
            Images of the points.
        point : ndarray, shape (n, 3)
            As triangulated from these, mm.
        scatter_px : float
            Variance component of the calibration along each axis, as a standard deviation, px.
        """
        n, width = len(point), 2 * len(chosen)
        q = np.empty((n, len(chosen), 2))
        by_point = np.empty((n, width, 3))
        by_cameras = np.zeros((n, width, parameter_count(cameras)))
        variance = np.zeros((n, width, width))
        places = parameter_slices(cameras)
        for column, number in enumerate(chosen):
            found = parameter_derivatives(cameras[number], point)
            at, place = slice(2 * column, 2 * column + 2), places[number]
            q[:, column], by_point[:, at] = found.q, found.by_point
            by_cameras[:, at, place] = found.by_parameters[:, :, : place.stop - place.start]
            variance[:, at, at] = matches.covariance[:, column] + scatter_px**2 * np.eye(2)
        _, _, axes = np.linalg.svd(by_point.transpose(0, 2, 1))
        null = axes[:, 3:].reshape(n, width - 3, width)
        return cls(
            null,
            np.einsum("nkw,nw->nk", null, (matches.q - q).reshape(n, width)),
            np.einsum("nkw,nwv,njv->nkj", null, variance, null),
            -np.einsum("nkw,nwp->nkp", null, by_cameras),
            q,
        )
