"""Meeting points of rays."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.geometry.covariances import clearly_definite


def closest_points(
    origins: Float64[np.ndarray, "n rays 3"], directions: Float64[np.ndarray, "n rays 3"]
) -> Vectors3:
    """Return the points nearest to bundles of rays, in the least-squares sense.

    Parameters
    ----------
    origins, directions : ndarray, shape (n, rays, 3)
        A point on each ray (mm) and its unit direction.

    Returns
    -------
    ndarray, shape (n, 3)
        Millimetres; NaN where the rays are parallel or a ray is NaN.

    Notes
    -----
    The point minimises the sum of squared distances to the lines, a linear system with the projectors
    ``I - v v'`` (Hartley and Sturm 1997 discuss why pixels should decide in the end).
    """
    projectors = np.eye(3) - directions[..., :, None] * directions[..., None, :]
    A = projectors.sum(axis=1)
    b = np.einsum("nrij,nrj->ni", projectors, origins)
    solvable = np.isfinite(A).all(axis=(1, 2)) & np.isfinite(b).all(axis=1)
    doubtful = solvable & ~clearly_definite(A, 1e-10)
    solvable[doubtful] = np.linalg.eigvalsh(A[doubtful])[:, 0] > 1e-12  # noqa: PLR2004 -- of a sum of projectors
    p = np.full((len(A), 3), np.nan)
    p[solvable] = np.linalg.solve(A[solvable], b[solvable][..., None])[..., 0]
    return p
