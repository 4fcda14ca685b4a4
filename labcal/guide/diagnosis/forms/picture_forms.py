"""Normal equations of single pictures, with columns for mistakes beside those of pose and lens."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.adjustment.rows import SHIFT, linearised_rows
from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.single_calibration import SingleCalibration
from labcal.optim.robust import SQUARES

BENT = 3
"""Columns of heights of the board: second powers of its coordinates."""
STRETCH = 1
"""Column of the ratio of the pitches."""
_HEIGHT_POWERS = ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
_PLANE_POWERS = ((2, 0), (1, 1), (0, 2), (3, 0), (2, 1), (1, 2), (0, 3))
SHAPE = STRETCH + len(_HEIGHT_POWERS) + 2 * len(_PLANE_POWERS)


@dataclass(frozen=True)
class PictureForms:
    """Products of the columns of each picture of one camera, linearised at its own calibration.

    Columns: pose of the target (a turn about its origin and a shift, along the camera's axes), parameters of
    the lens, shape of the board, the pose again times the height in the picture (-0.5 at the top, 0.5 at the
    bottom), and last the residual; in units of standard deviations.

    Attributes
    ----------
    camera : SingleCalibration
    lens : int
        Number of the lens's parameters.
    products : float64 array, (pictures, columns, columns)
    dots : float64 array, (pictures,)
        Number of dots.
    """

    camera: SingleCalibration
    lens: int
    products: Float64[np.ndarray, "pictures columns columns"]
    dots: Float64[np.ndarray, " pictures"]

    @classmethod
    def of(cls, camera: SingleCalibration) -> "PictureForms":
        """Return those of a camera."""
        end = camera.result.adjusted
        dots = camera.result.observations.moved(-end.eccentricity).where(~end.outlier)
        dots = dots.scattered(end.scatter_px**2)
        free = end.layout.lens[0].stop - end.layout.lens[0].start
        predicted = dots.q[:, 1] + end.residual[~end.outlier, 1]  # free of the noise of what is explained
        views, height = len(end.state.T_world_target), end.state.cameras[0].size[1]
        columns = POSE + free + SHAPE + POSE + 1
        products = np.zeros((views, columns, columns))
        counts = np.zeros(views)
        plane = end.state.dots[:, :2] - end.state.dots[:, :2].mean(axis=0)
        plane = plane / np.abs(plane).max()
        for run in dots.runs:
            rows = linearised_rows(end.layout, dots, run, SQUARES)
            for picture, at in run.within():
                lens, pose, residual = rows[:free, :, at], rows[free : free + POSE, :, at], rows[-1:, :, at]
                R = end.state.T_world_target[picture.view, :3, :3]
                place = plane[dots.dot[picture.rows]]
                shape = _by_shape(rows[SHIFT, :, at], R, place)
                rolled = pose * (predicted[picture.rows] / height - 0.5)
                # The residual is predicted minus measured: what a parameter adds lies on the same side.
                all_ = np.concatenate([pose, lens, shape, rolled, residual]).reshape(columns, -1)
                products[picture.view] = all_ @ all_.T
                counts[picture.view] = len(place)
        return cls(camera, free, products, counts)


def _by_shape(
    by_shift: Float64[np.ndarray, "3 2 n"], R: Float64[np.ndarray, "3 3"], place: Float64[np.ndarray, "n 2"]
) -> Float64[np.ndarray, "shape 2 n"]:
    """Return derivatives by the shape of the board, per mm at the end of its longer side."""
    x, y = place.T
    across, along, up = (np.einsum("a,akn->kn", R[:, axis], by_shift) for axis in range(3))
    return np.stack(
        [
            across * x,
            *(up * (x**i * y**j) for i, j in _HEIGHT_POWERS),
            *(across * (x**i * y**j) for i, j in _PLANE_POWERS),
            *(along * (x**i * y**j) for i, j in _PLANE_POWERS),
        ]
    )
