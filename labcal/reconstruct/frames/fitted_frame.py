"""A frame in the world of a rig, with its covariance, and points brought into it."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import Matrix3, PointCovariances, Vectors3
from labcal.correspond.named_points import NamedPoints
from labcal.geometry.cross_matrices import cross_matrices


class FrameKind(StrEnum):
    """Ways to name a frame."""

    POINTS = "points"
    """By three points: the origin, one on the x axis, one in the plane of x and y."""
    BOARD = "board"
    """By a target that lies in it: the target's own frame."""
    RIGID = "rigid"
    """By known points; rotation and translation are fitted."""
    SIMILARITY = "similarity"
    """By known points; rotation, translation and scale are fitted."""


FREE = np.tri(3, k=-1)
"""Coordinates of the three points of `POINTS` that are not 0 by decree."""


@dataclass(frozen=True)
class FrameCalibration:
    """The share in the errors of a frame of errors that all points have in common.

    They are those of the cameras; after scale bars also the noise of the bars' ends and the bars' lengths.
    """

    by_cameras: Float64[np.ndarray, "parameters cameras"]
    """Derivatives of the frame's parameters by those of the cameras."""
    covariance: Float64[np.ndarray, "cameras cameras"]
    """Joint covariance of the cameras' parameters."""


@dataclass(frozen=True)
class FittedFrame:
    """A frame b: a point of the model's world a has there the coordinates ``scale R_ba p_a + t_ba``.

    Its parameters are the rotation vector that turns points in b further (radians), the translation (mm) and,
    of a similarity, the logarithm of the scale.
    """

    kind: FrameKind
    view: str
    """The view whose points determine it."""
    names: tuple[str, ...]
    """Names of the points that determine it; of a board, its dots."""
    R_ba: Matrix3
    t_ba: Float64[np.ndarray, "3"]
    scale: float
    slopes: Float64[np.ndarray, "n parameters 3"]
    """Derivatives of the parameters by the coordinates of these points in a."""
    covariance: PointCovariances
    """(n, 3, 3), of these points in a by their noise, mm squared."""
    known: Float64[np.ndarray, "parameters parameters"]
    """Share of the known coordinates in the covariance of the parameters; 0 where they count as exact."""
    middle: Float64[np.ndarray, "3"]
    """Mean of these points in b, mm."""
    residual: Vectors3
    """(n, 3), of these points in b: measured minus known, mm, as far as they are known."""
    sigma0: float | None
    """Root of the residuals' chi-square over its degrees of freedom; None where none are left."""
    warnings: tuple[str, ...] = ()
    calibration: FrameCalibration | None = None
    """The cameras' share; None where they count as exact."""

    @property
    def noise_covariance(self) -> Float64[np.ndarray, "parameters parameters"]:
        """Covariance of the parameters by noise and known coordinates; the cameras count as exact."""
        shares = self.slopes @ self.covariance @ self.slopes.swapaxes(1, 2)
        return np.asarray(shares.sum(axis=0) + self.known)

    @property
    def parameter_covariance(self) -> Float64[np.ndarray, "parameters parameters"]:
        """Covariance of the parameters by all that is known of their errors."""
        if self.calibration is None:
            return self.noise_covariance
        by = self.calibration.by_cameras
        return np.asarray(self.noise_covariance + by @ self.calibration.covariance @ by.T)

    @property
    def shared_errors(
        self,
    ) -> tuple[
        Float64[np.ndarray, "parameters shared"],
        Float64[np.ndarray, "shared shared"],
        Bool[np.ndarray, " shared"],
    ]:
        """Derivatives of the parameters by errors other than the cameras', their covariance, and a mask.

        The errors are the noise of each point that determines the frame, then what the known coordinates do
        to each parameter, which the mask marks. No point is one of a board's dots, whose noise is put
        together.
        """
        parameters = self.slopes.shape[1]
        if self.kind is FrameKind.BOARD:
            return np.eye(parameters), self.noise_covariance, np.zeros(parameters, dtype=bool)
        count = 3 * len(self.slopes)
        by = np.concatenate([self.slopes.swapaxes(0, 1).reshape(parameters, count), np.eye(parameters)], 1)
        covariance = np.zeros((count + parameters, count + parameters))
        for number, own in enumerate(self.covariance):
            at = slice(3 * number, 3 * number + 3)
            covariance[at, at] = own
        covariance[count:, count:] = self.known
        return by, covariance, np.arange(count + parameters) >= count

    @property
    def place_covariance(self) -> Float64[np.ndarray, "3 3"]:
        """Covariance of the frame's place in the middle of the points that determine it, mm squared."""
        by_frame = by_parameters((self.middle - self.t_ba)[None], self.slopes.shape[1])[0]
        return np.asarray(by_frame @ self.parameter_covariance @ by_frame.T)

    @property
    def rms_mm(self) -> float:
        """Root mean square of the 3-D residuals, mm."""
        return float(np.sqrt((self.residual**2).sum(axis=1).mean()))

    def applied(self, points: NamedPoints) -> NamedPoints:
        """Return points in this frame, with covariances of noise that hold its own; cameras are exact.

        A point that determines the frame is correlated with it, which is counted: by three points, the origin
        has no covariance, and the point on the x axis has one along this axis alone.
        """
        turned = self.scale * points.point @ self.R_ba.T
        by_point = self.scale * self.R_ba
        by_frame = by_parameters(turned, self.slopes.shape[1])
        covariance = by_point @ points.covariance @ by_point.T
        covariance += by_frame @ self.noise_covariance @ by_frame.swapaxes(1, 2)
        place = turned + self.t_ba
        for row, at in self.own_rows(points):
            covariance[row] = self._own_covariance(at, by_frame[row])
            if self.kind is FrameKind.POINTS:  # but for rounding
                place[row] *= FREE[at]
                covariance[row] *= np.outer(FREE[at], FREE[at])
        covariance = 0.5 * (covariance + covariance.swapaxes(1, 2)) + 0.0
        return NamedPoints(points.view, points.name, place + 0.0, covariance, points.flag)

    def own_rows(self, points: NamedPoints) -> list[tuple[int, int]]:
        """Return the rows of the points that determine the frame, each with its place among them."""
        if self.kind is FrameKind.BOARD:
            return []
        of_view = np.flatnonzero(points.view == self.view)
        row = dict(zip(points.name[of_view].tolist(), of_view.tolist(), strict=True))
        return [(row[name], at) for at, name in enumerate(self.names) if name in row]

    def _own_covariance(
        self, at: int, by_frame: Float64[np.ndarray, "3 parameters"]
    ) -> Float64[np.ndarray, "3 3"]:
        """Return the covariance of a point that determines the frame, as a sum that cannot cancel."""
        by_points = by_frame @ self.slopes
        by_points[at] += self.scale * self.R_ba
        shares = by_points @ self.covariance @ by_points.swapaxes(1, 2)
        return np.asarray(shares.sum(axis=0) + by_frame @ self.known @ by_frame.T)


def by_parameters(turned: Vectors3, parameters: int) -> Float64[np.ndarray, "n 3 parameters"]:
    """Return the derivatives of points in b by the parameters of a frame.

    Parameters
    ----------
    turned : ndarray, shape (n, 3)
        ``scale R_ba p_a``, mm.
    parameters : int
        6, or 7 with a scale.
    """
    moved = np.broadcast_to(np.eye(3), (len(turned), 3, 3))
    every = np.concatenate([-cross_matrices(turned), moved, turned[:, :, None]], axis=2)
    return np.asarray(every[:, :, :parameters])
