"""Points and lengths that two calibrations of one rig find from the same pixels, against both budgets."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.rng import generator

KEPT = 0.999
"""Share of the variance of differences that the directions hold which are compared: others do not matter."""
_STEPS = 6
"""Places along each axis of the volume."""
_LENGTHS = 300


@dataclass(frozen=True)
class HalfDifference:
    """Differences in units of their covariance.

    Attributes
    ----------
    squares : float
        Follows chi-square where both budgets hold.
    freedom : int
        Directions that are compared. Points of one rig share its errors: these are few, however many points.
    rms_mm, expected_mm : float
        Of the differences.
    """

    squares: float
    freedom: int
    rms_mm: float
    expected_mm: float

    @classmethod
    def of(
        cls, difference: Float64[np.ndarray, " n"], root: Float64[np.ndarray, "n errors"]
    ) -> "HalfDifference":
        """Compare differences, mm, with their covariance ``root @ root.T``."""
        axes, size, _ = np.linalg.svd(root, full_matrices=False)
        held = np.cumsum(size**2) / (size**2).sum()
        freedom = int(np.searchsorted(held, KEPT)) + 1
        along = (axes.T @ difference)[:freedom] / size[:freedom]
        count = len(difference)
        return cls(
            float((along**2).sum()),
            freedom,
            float(np.sqrt((difference**2).mean())),
            float(np.sqrt((size**2).sum() / count)),
        )


def point_differences(
    one: HandheldCalibration, other: HandheldCalibration
) -> tuple[HalfDifference, HalfDifference]:
    """Return the differences of points, and of the lengths between them, all over the common volume.

    Parameters
    ----------
    one, other : HandheldCalibration
        Of the same cameras, from different views of one print. Pixels are the images of a grid of places in
        the cameras of `one`: no dots of the board.

    Returns
    -------
    HalfDifference, HalfDifference
        Of points in the first camera's frame, and of lengths.

    Raises
    ------
    InputError
        A calibration states no covariance, or the pictures have no volume in common.

    Notes
    -----
    Covariances are without the print's share: both saw the same print, whose errors do not part them.
    """
    cameras, others = _cameras(one), _cameras(other)
    place = _places(one, [*cameras, *others])
    q = np.stack([camera.project(place).q for camera in cameras], axis=1)
    noise = np.tile(np.eye(2), (len(place), len(cameras), 1, 1))
    found = triangulate(others, q, noise).point
    roots = [
        triangulation_derivatives(at, p, noise) @ _root(_own_covariance(half))
        for half, at, p in ((one, cameras, place), (other, others, found))
    ]
    root = np.concatenate(roots, axis=2)
    off = found - place
    pair = generator(0, "bench solve", "lengths of halves").integers(0, len(place), (_LENGTHS, 2))
    first, second = pair[pair[:, 0] != pair[:, 1]].T
    length = np.linalg.norm(place[first] - place[second], axis=1)
    along = (place[first] - place[second]) / length[:, None]
    longer = np.linalg.norm(found[first] - found[second], axis=1) - length
    of_lengths = np.einsum("ni,nik->nk", along, root[first] - root[second])
    return (
        HalfDifference.of(off.ravel(), root.reshape(off.size, -1)),
        HalfDifference.of(longer, of_lengths),
    )


def _cameras(found: HandheldCalibration) -> list[Camera]:
    return [found.rig.camera(name) for name in found.rig.cameras]


def _places(found: HandheldCalibration, cameras: list[Camera]) -> Vectors3:
    """Return a grid of places in the volume of the board's dots that all cameras see."""
    dots = np.concatenate([transform(T, found.dots) for T in found.T_world_target])
    axes = [
        np.linspace(low, high, _STEPS) for low, high in zip(dots.min(axis=0), dots.max(axis=0), strict=True)
    ]
    place = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    images = [(camera, camera.project(place)) for camera in cameras]
    seen = np.all([image.ok & camera.in_picture(image.q) for camera, image in images], axis=0)
    if np.count_nonzero(seen) <= 1:
        raise InputError(
            "The pictures of the cameras have no volume in common. Take views that all of them see."
        )
    return np.asarray(place[seen])


def _own_covariance(found: HandheldCalibration) -> Float64[np.ndarray, "n n"]:
    """Return the covariance of the cameras without the print's share."""
    if found.rig.covariance is None or found.sources.print_share is None:
        raise InputError("A calibration states no covariance. Calibrate with free lenses.")
    return np.asarray(found.rig.covariance.matrix - found.sources.print_share.covariance)


def _root(covariance: Float64[np.ndarray, "n n"]) -> Float64[np.ndarray, "n n"]:
    """Return a matrix whose product with its transpose is the covariance, which may have no full rank."""
    scale = np.sqrt(np.where(np.diagonal(covariance) > 0.0, np.diagonal(covariance), 1.0))
    size, axes = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * axes * np.sqrt(np.maximum(size, 0.0)))
