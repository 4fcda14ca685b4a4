"""A board on planes across a volume, as planned, and its exact pixels however it was really taken."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.geometry.poses import pose
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.take import Take

_CAMERAS = ("first", "second")


@dataclass(frozen=True)
class PlannedPlanes:
    """One board, taken by two cameras on several planes, its x and y along those of the world.

    Attributes
    ----------
    dots : float64 array, (dots, 3)
        Declared places in the target's frame, whose origin is dot (0, 0), mm.
    takes : tuple of Take
        The pictures as planned, view by view, camera by camera.
    seed : int
    """

    dots: Vectors3
    takes: tuple[Take, ...]
    seed: int

    @classmethod
    def of(cls, Y: Vectors3, pair: tuple[Camera, Camera], seed: int) -> "PlannedPlanes":
        """Return the plan of training points.

        Parameters
        ----------
        Y : float64 array, (n, 3)
            The same grid on every plane, plane after plane, mm.
        pair : tuple of Camera
        seed : int
        """
        heights = np.unique(Y[:, 2])
        board = Y[: len(Y) // len(heights)]
        origin = board.min(axis=0)
        middle = 0.5 * (origin + board.max(axis=0))
        still = np.zeros(3)
        takes = tuple(
            Take(
                f"plane-{number}",
                name,
                name,
                camera,
                Track(pose(np.eye(3), origin + rise), middle + rise, still, still),
                ShutterTimes(0.0, 0.0, camera.size[1]),
            )
            for number, rise in enumerate(_rises(heights), start=1)
            for name, camera in zip(_CAMERAS, pair, strict=True)
        )
        return cls(board - origin, takes, seed)

    @property
    def middle(self) -> Float64[np.ndarray, "2"]:
        """The middle of the dots in the target's frame, mm."""
        return np.asarray(0.5 * (self.dots.min(axis=0) + self.dots.max(axis=0))[:2])

    @property
    def half(self) -> Float64[np.ndarray, "2"]:
        """Half the width and half the height over which there are dots, mm."""
        return np.asarray(0.5 * np.ptp(self.dots[:, :2], axis=0))

    def images(self, dots: Vectors3, takes: Sequence[Take]) -> Float64[np.ndarray, "n 2 2"]:
        """Return exact pixels of the training points, in their order; NaN where a camera has no image.

        Parameters
        ----------
        dots : float64 array, (dots, 3)
            True places in the target's frame, mm.
        takes : sequence of Take
            The pictures as taken, in the planned order.
        """
        q = np.stack([take.project(dots).q for take in takes])
        by_view = q.reshape(-1, len(_CAMERAS), len(dots), 2)
        return np.ascontiguousarray(by_view.transpose(0, 2, 1, 3).reshape(-1, len(_CAMERAS), 2))


def _rises(heights: np.ndarray) -> Vectors3:
    """Return how far each plane is above the first one, as vectors, (planes, 3)."""
    return np.outer(heights - heights[0], [0.0, 0.0, 1.0])
