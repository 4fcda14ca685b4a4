"""The share of free dots in the normal equations."""

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.observations import Picture
from labcal.calibrate.adjustment.rows import SHIFT
from labcal.calibrate.adjustment.state import POSE, Layout


class DotSums:
    """Sums over observations for every dot by itself, before its freedom is applied.

    Parameters
    ----------
    dots, views, shared : int
        How many there are, of shared parameters all.
    """

    def __init__(self, dots: int, views: int, shared: int) -> None:
        self._square = np.zeros((3, 3, dots))
        self._shared = np.zeros((3, shared, dots))
        self._view = np.zeros((views, 3, POSE, dots))
        self._gradient = np.zeros((3, dots))

    def add(
        self,
        layout: Layout,
        picture: Picture,
        rows: Float64[np.ndarray, "width 2 n"],
        moves: Float64[np.ndarray, "width parameters"],
        dots: Int64[np.ndarray, " n"],
    ) -> None:
        """Add the rows of one picture, which shows each of its dots once."""
        R_cam_world = layout.state.cameras[picture.camera].T_cam_world[:3, :3]
        R_cam_target = R_cam_world @ layout.state.T_world_target[picture.view, :3, :3]
        of_dot = np.tensordot(R_cam_target, rows[SHIFT], axes=(0, 0))
        product = of_dot[:, None, 0] * rows[:, 0] + of_dot[:, None, 1] * rows[:, 1]
        along = moves.T @ product
        own = layout.own(picture.camera)
        width = own.stop - own.start
        self._square[:, :, dots] += of_dot[:, None, 0] * of_dot[:, 0] + of_dot[:, None, 1] * of_dot[:, 1]
        self._shared[:, own, dots] += along[:, :width]
        of_view = self._view[picture.view]
        of_view[:, :, dots] += along[:, width:-1]
        self._gradient[:, dots] += along[:, -1]

    def enter(
        self,
        layout: Layout,
        shared: Float64[np.ndarray, "shared shared"],
        cross: Float64[np.ndarray, "views shared 6"],
        gradient: Float64[np.ndarray, " shared"],
    ) -> None:
        """Write the free directions' share into normal equations."""
        basis, at = layout.freedom.dots, layout.dots
        coordinates, free = basis.shape
        square = self._square.transpose(2, 0, 1) @ basis.reshape(-1, 3, free)
        shared[at, at] = basis.T @ square.reshape(coordinates, free)
        along = basis.T @ self._shared.transpose(2, 0, 1).reshape(coordinates, -1)
        shared[at] += along
        shared[:, at] += along.T
        by_view = self._view.transpose(3, 1, 0, 2).reshape(coordinates, -1)
        cross[:, at] = (basis.T @ by_view).reshape(free, -1, POSE).transpose(1, 0, 2)
        gradient[at] = basis.T @ self._gradient.T.ravel()
