"""Projective maps to an image by the direct linear transform, and a robust one for data with outliers."""

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels
from labcal.errors import InputError
from labcal.geometry.arrangement import refuse_one_pixel

AMBIGUOUS = 1e-10
"""Below this fraction of the largest singular value, a second solution fits as well as the first."""


def normalising_similarity(points: Float64[np.ndarray, "n dim"]) -> Float64[np.ndarray, "dim1 dim1"]:
    """Return the similarity, homogeneous, after which points have mean 0 and RMS distance sqrt(dim).

    Hartley, "In defense of the eight-point algorithm", PAMI 1997.
    """
    count, dimension = points.shape
    mean = points.mean(axis=0)
    scale = np.sqrt(dimension * count) / np.linalg.norm(points - mean)
    similarity: np.ndarray = np.eye(dimension + 1) * scale
    similarity[:dimension, dimension] = -scale * mean
    similarity[dimension, dimension] = 1.0
    return similarity


def homogeneous(points: Float64[np.ndarray, "n dim"]) -> Float64[np.ndarray, "n dim1"]:
    """Return points with a further coordinate 1."""
    count, dimension = points.shape
    with_one = np.ones((count, dimension + 1))
    with_one[:, :dimension] = points
    return with_one


def projective_map(
    method: str, sources: Float64[np.ndarray, "n dim"], pixels: Pixels
) -> Float64[np.ndarray, "3 dim1"]:
    """Return the matrix M with pixels ~ M sources, in homogeneous coordinates.

    The direct linear transform: two equations a point, the vector of least singular value, all in normalised
    coordinates. Hartley and Zisserman, Multiple View Geometry, 2nd ed., algorithms 4.2 and 7.1.

    Parameters
    ----------
    method : str
        The name of the method, for messages.
    sources : float64 array, (n, 2) or (n, 3)
        Points of a plane or of space, mm; their arrangement has been checked.
    pixels : float64 array, (n, 2)
        Where they are seen, px.

    Returns
    -------
    float64 array, (3, 3) or (3, 4)
        Of Frobenius norm 1, the sign such that the third coordinate is positive at the centre of the points.

    Raises
    ------
    InputError
        The points determine more than one map.
    """
    refuse_one_pixel(method, pixels)
    to_source, to_image = normalising_similarity(sources), normalising_similarity(pixels)
    source = homogeneous(sources) @ to_source.T
    image = homogeneous(pixels) @ to_image.T
    count, size = source.shape
    equations = np.zeros((2, count, 3 * size))
    for axis in (0, 1):
        equations[axis, :, axis * size : (axis + 1) * size] = source
        equations[axis, :, 2 * size :] = -image[:, axis : axis + 1] * source
    # Only the triangle: it has the same singular values and directions, and stays small for many points.
    triangle = np.linalg.qr(equations.reshape(2 * count, -1), mode="r")
    _, singular, directions = np.linalg.svd(triangle)
    if singular[len(directions) - 2] <= AMBIGUOUS * singular[0]:
        raise InputError(
            f"{method}: the dots are in an arrangement that leaves a camera undetermined (many on one "
            f"line or plane, or seen at the same pixels). Train on dots that fill the view and differ in "
            "depth."
        )
    normalised = directions[-1].reshape(3, -1)
    found = np.linalg.solve(to_image, normalised @ to_source)
    found /= np.linalg.norm(found)
    sign = np.sign(found[2] @ homogeneous(sources.mean(axis=0)[None])[0])
    return found * (sign or 1.0)


def robust_homography(sources: Pixels, pixels: Pixels) -> Float64[np.ndarray, "3 3"] | None:
    """Return a homography that tolerates outliers (least median of squares, Rousseeuw 1984).

    Parameters
    ----------
    sources, pixels : ndarray, shape (n, 2)
        Points of a plane, and where they are seen; fewer than half of them may be wrong.

    Returns
    -------
    ndarray, shape (3, 3), or None
        None where the points determine none.
    """
    import cv2  # noqa: PLC0415 -- a large library

    found, _ = cv2.findHomography(sources, pixels, cv2.LMEDS)
    return None if found is None else np.asarray(found, dtype=np.float64)
