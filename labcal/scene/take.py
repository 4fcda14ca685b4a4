"""One picture as taken: its true camera, and the motion of the target."""

import math
from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.cameras.imaging import Projection
from labcal.scene.motion import ShutterTimes, Track
from labcal.scene.photometry import Photometry

STEPS = 100
SETTLED_PX = 1e-10


@dataclass(frozen=True)
class Take:
    """One picture, and all its true values."""

    view: str
    camera: str
    """Name under which the picture is delivered."""
    taken_by: str
    """Name of the camera that took it; another one only by mistake."""
    device: Camera
    """That camera, where it really stood."""
    track: Track
    shutter: ShutterTimes
    defocus_px: float = 0.0
    """Standard deviation of a blur on top of the lens's own."""

    def photometry(self, of_scene: Photometry) -> Photometry:
        """Return the photometry of this picture, which is the scene's unless it is out of focus."""
        blur_px = math.hypot(of_scene.blur_px, self.defocus_px)
        return of_scene if self.defocus_px == 0.0 else of_scene.model_copy(update={"blur_px": blur_px})

    def instants(self, p: Vectors3) -> np.ndarray:
        """Return the middle of the exposure of the row on which each point is imaged.

        Found by iteration on the row, which converges as long as an image moves by less than the picture's
        height while that is read.

        Parameters
        ----------
        p : ndarray, shape (..., 3)
            Target frame, mm.

        Returns
        -------
        ndarray, shape (...)
            Seconds from the middle of the frame; NaN where the point is not imaged, or no row is found.
        """
        seconds = np.zeros(p.shape[:-1])
        if self.track.stands_still or self.shutter.readout_s == 0.0:
            return seconds
        row = self._rows(p, seconds)
        for _ in range(STEPS):
            seconds = self.shutter.middles(np.where(np.isfinite(row), row, 0.0))  # SciPy turns by no NaN
            before, row = row, self._rows(p, seconds)
            settled = np.abs(row - before) <= SETTLED_PX
            if (settled | np.isnan(row)).all():
                break
        return np.where(settled, seconds, np.nan)

    def _rows(self, p: Vectors3, seconds: np.ndarray) -> np.ndarray:
        """Return the rows on which points of the target are imaged, each at its own time."""
        return np.asarray(self.device.project(self.track.carried(p, seconds)).q[..., 1])

    def project(self, p: Vectors3) -> Projection:
        """Return the pixels of points of the target, at the middle of the exposure of their own row.

        Parameters
        ----------
        p : ndarray, shape (..., 3)
            Target frame, mm.

        Returns
        -------
        Projection
            Not ok also where no row is found that sees the point in the middle of its exposure.
        """
        seconds = self.instants(p)
        found = np.isfinite(seconds)
        seen = self.device.project(self.track.carried(p, np.where(found, seconds, 0.0)))
        ok = seen.ok & found
        return Projection(np.where(ok[..., None], seen.q, np.nan), ok)
