"""The data of rows 01 to 15: points seen by two cameras of the paper's own model (Eq. 1 to 11)."""

from enum import StrEnum

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.paper import PaperCamera
from labcal.paper.problem import Problem
from labcal.paper.rows import Data, PaperRow
from labcal.rng import generator

LOW_MM, HIGH_MM = 650.0, 1350.0
"""The area in X and Y."""
PLANE_MM, OTHER_PLANE_MM, HEIGHT_MM = 200.0, 500.0, 1000.0
"""Z of the plane and of "another plane", and the height of the volume."""
TESTS = 1000
FOCAL_LENGTH_MM = 8.0
FOCAL_RATIO = 1.3
"""Row 06: the second model of camera has a focal length longer by 30%."""
PIXEL_MM = 0.01
"""Pixel of the simulated sensor; the paper gives none. It matters only where noise is 5% of a pixel."""
NOISE = 0.05

_GRIDS: dict[tuple[Data, int], tuple[int, ...]] = {
    (Data.PLANE, 300): (20, 15),
    (Data.PLANE, 250): (25, 10),
    (Data.PLANE, 150): (15, 10),
    (Data.OTHER_PLANE, 250): (25, 10),
    (Data.FOCAL_LENGTHS, 200): (10, 10),
    (Data.VOLUME, 100): (5, 5, 4),
    (Data.VOLUME, 200): (10, 5, 4),
    (Data.VOLUME, 300): (10, 10, 3),
    (Data.VOLUME, 520): (13, 10, 4),
}
"""Points along X, Y and Z of each regular grid (for row 06: of each of the two camera models)."""


class NoiseReading(StrEnum):
    """The quantity of which a Gaussian error is 5%."""

    NONE = "none"
    SPREAD = "5% of the coordinate's standard deviation"
    PIXEL = "5% of a pixel"


GIMBALS_MM = ((600.0, 500.0, 2450.0), (1400.0, 500.0, 2450.0))
LOOK_AT_MM = (1000.0, 1000.0, 500.0)
"""The paper gives no poses: one rig for all rows, 2 m from the middle of the volume that it looks at.

It must not look at the middle of the plane of row 06, where a longer lens and a larger plane look the same.
"""


def cameras(focal_length_mm: float) -> tuple[PaperCamera, PaperCamera]:
    """Return the two cameras."""
    left, right = (_looking_at(np.array(LOOK_AT_MM), np.array(at), focal_length_mm) for at in GIMBALS_MM)
    return left, right


def _looking_at(centre: np.ndarray, gimbal: np.ndarray, focal_length_mm: float) -> PaperCamera:
    """Return a camera on a gimbal, panned and tilted towards a point.

    The view is the last row of R (Eq. 4), (sin theta sin alpha, -cos theta sin alpha, cos alpha).
    """
    view = centre - gimbal
    x, y, z = view / np.linalg.norm(view)
    return PaperCamera(focal_length_mm, gimbal, float(np.arctan2(x, -y)), float(np.arccos(z)), np.zeros(3))


def simulate(row: PaperRow, noise: NoiseReading, seed: int) -> Problem:
    """Return the data of a simulated row.

    Parameters
    ----------
    row : PaperRow
    noise : NoiseReading
        Added to the trained and the tested image coordinates alike: a user's pictures are as noisy.
    seed : int
        Draws the random points, the test points and the noise.
    """
    rng = generator(seed, "paper", row.exp, noise)
    if row.data is Data.FOCAL_LENGTHS:
        return _two_focal_lengths(row, rng)
    low, high = box(row.data)
    is_random = row.data is Data.VOLUME_RANDOM
    trained = rng.uniform(low, high, (row.points, 3)) if is_random else grid(row.data, row.points)
    tested = rng.uniform(low, high, (TESTS, 3))
    pair = cameras(FOCAL_LENGTH_MM)
    X, X_test = image_coordinates(pair, trained), image_coordinates(pair, tested)
    sigma = noise_sigma(X, noise)
    return Problem(
        X=X + sigma * rng.standard_normal(X.shape),
        Y=trained,
        X_test=X_test + sigma * rng.standard_normal(X_test.shape),
        Y_test=tested,
    )


def noise_sigma(X: np.ndarray, noise: NoiseReading) -> np.ndarray:
    """Return the standard deviation of the noise of every image coordinate, mm."""
    if noise is NoiseReading.SPREAD:
        return np.asarray(NOISE * X.std(axis=0))
    return np.full(X.shape[1], NOISE * PIXEL_MM if noise is NoiseReading.PIXEL else 0.0)


def _two_focal_lengths(row: PaperRow, rng: np.random.Generator) -> Problem:
    """Return points seen by both camera models, with focal lengths (mm) as two further outputs."""
    low, high = box(row.data)
    parts = []
    for focal_length in (FOCAL_LENGTH_MM, FOCAL_RATIO * FOCAL_LENGTH_MM):
        pair = cameras(focal_length)
        for points in (grid(row.data, row.points), rng.uniform(low, high, (TESTS // 2, 3))):
            focal = np.full((len(points), 2), focal_length)
            parts.append((image_coordinates(pair, points), np.concatenate([points, focal], axis=1)))
    (X_a, Y_a), (Xt_a, Yt_a), (X_b, Y_b), (Xt_b, Yt_b) = parts
    return Problem(
        np.concatenate([X_a, X_b]), np.concatenate([Y_a, Y_b]),
        np.concatenate([Xt_a, Xt_b]), np.concatenate([Yt_a, Yt_b]),
    )  # fmt: skip


def image_coordinates(pair: tuple[PaperCamera, PaperCamera], p: Vectors3) -> np.ndarray:
    """Return x1 y1 x2 y2 on the image planes, mm."""
    return np.concatenate([camera.project(p)[0] for camera in pair], axis=1)


def box(data: Data) -> tuple[np.ndarray, np.ndarray]:
    """Return the corners of the plane or volume of simulated data, mm."""
    if data in {Data.VOLUME, Data.VOLUME_RANDOM}:
        z_low, z_high = 0.0, HEIGHT_MM
    else:
        z_low = z_high = OTHER_PLANE_MM if data is Data.OTHER_PLANE else PLANE_MM
    return np.array([LOW_MM, LOW_MM, z_low]), np.array([HIGH_MM, HIGH_MM, z_high])


def grid(data: Data, points: int) -> Vectors3:
    """Return the regular grid of a row, borders included, mm.

    Parameters
    ----------
    data : Data
    points : int
        A number that a row of the paper has on such data.
    """
    low, high = box(data)
    counts = (*_GRIDS[data, points], 1)[:3]
    axes = [np.linspace(a, b, count) for a, b, count in zip(low, high, counts, strict=True)]
    return np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
