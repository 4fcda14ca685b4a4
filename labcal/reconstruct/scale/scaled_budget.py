"""Points of one rig after known distances between some of them have entered as observations."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import AnyArray, PointCovariances, Vectors3, lines_array
from labcal.cameras.derivatives import RUN
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.point_errors import PointErrors


@dataclass(frozen=True)
class BarEquations:
    """Linear equations of J bars: errors of their ends, and their lengths.

    The misclosures, measured minus stated length, are the sum of three products: of `by_ends` with the noise
    of the ends, of `by_cameras` with the errors of the cameras and of the scale, of `by_bars` with those of
    the stated lengths.
    """

    lines: Int64[np.ndarray, " m"]
    """Of the points that are ends, each once."""
    ends: Float64[np.ndarray, "ends ends"]
    """Covariance of their noise, mm squared; 3 m."""
    cameras: Float64[np.ndarray, "cameras cameras"]
    """Covariance of the cameras' parameters, and of the scale (last)."""
    bars: Float64[np.ndarray, "bars bars"]
    """Covariance of the stated lengths, mm squared."""
    by_ends: Float64[np.ndarray, "J ends"]
    by_cameras: Float64[np.ndarray, "J cameras"]
    by_bars: Float64[np.ndarray, "J bars"]

    @cached_property
    def covariance(self) -> Float64[np.ndarray, "J J"]:
        """Covariance of the misclosures, mm squared."""
        return np.asarray(
            self.by_ends @ self.ends @ self.by_ends.T
            + self.by_cameras @ self.cameras @ self.by_cameras.T
            + self.by_bars @ self.bars @ self.by_bars.T
        )

    @cached_property
    def gains(self) -> tuple[Float64[np.ndarray, "ends J"], Float64[np.ndarray, "cameras J"]]:
        """Changes of the ends' noise and of the cameras' errors as expected by misclosures."""
        weight = np.linalg.inv(self.covariance)
        return self.ends @ self.by_ends.T @ weight, self.cameras @ self.by_cameras.T @ weight


@dataclass(frozen=True, eq=False)
class ScaledBudget:
    """Both shares of the errors of points of one rig that scale bars corrected.

    Errors are linear functions of the same sources as before, and of the errors of the bars' lengths: what
    the bars say of the sources is taken off. So the shares stay what they were: noise, cameras, lengths.

    Attributes
    ----------
    world : PointBudget
        Before.
    ratio : float
        By which all points were multiplied first, so that what is left of the scale is small.
    equations : BarEquations
    """

    world: PointBudget
    ratio: float
    equations: BarEquations

    @property
    def kind(self) -> Budget:
        """The sources of errors that it holds."""
        return self.world.kind

    def __len__(self) -> int:
        return len(self.world)

    def errors(self, lines: AnyArray) -> PointErrors:
        """Return the sources of the errors of some points: their numbers, or a mask."""
        numbers = np.arange(len(self))[lines_array(lines, len(self), "lines")]
        own, by_ends, by_cameras = self._before(numbers)
        equations, (of_ends, of_cameras) = self.equations, self.equations.gains
        gain = by_ends @ of_ends + by_cameras @ of_cameras
        shared = np.zeros((by_ends.shape[2] + len(equations.bars),) * 2)
        ends = by_ends.shape[2]
        shared[:ends, :ends], shared[ends:, ends:] = equations.ends, equations.bars
        return PointErrors(
            own,
            np.concatenate([by_ends - gain @ equations.by_ends, -gain @ equations.by_bars], axis=2),
            shared,
            np.arange(len(shared)) >= ends,
            by_cameras - gain @ equations.by_cameras,
            equations.cameras,
        )

    def corrected(self, lines: Int64[np.ndarray, " k"], off: Float64[np.ndarray, " J"]) -> Vectors3:
        """Return points by the numbers of their lines, mm, corrected by misclosures of bars (mm)."""
        _, by_ends, by_cameras = self._before(lines)
        of_ends, of_cameras = self.equations.gains
        wrong = by_ends @ (of_ends @ off) + by_cameras @ (of_cameras @ off)
        return np.asarray(self.ratio * self.world.point[lines] - wrong)

    def _before(
        self, numbers: Int64[np.ndarray, " k"]
    ) -> tuple[PointCovariances, Float64[np.ndarray, "k 3 ends"], Float64[np.ndarray, "k 3 cameras"]]:
        """Return own noise, and derivatives by the ends' noise and by cameras and scale, before the bars."""
        inside, ends = self.world.errors(numbers), self.equations.lines
        own, by_ends = self.ratio**2 * inside.own, np.zeros((len(numbers), 3, 3 * len(ends)))
        for at, line in enumerate(ends.tolist()):
            for row in np.flatnonzero(numbers == line).tolist():
                own[row], by_ends[row][:, 3 * at : 3 * at + 3] = 0.0, np.eye(3)
        # An error of the scale moves a point along itself.
        by_cameras = np.concatenate([inside.by_cameras, self.world.point[numbers][:, :, None]], axis=2)
        return own, by_ends, self.ratio * by_cameras

    @cached_property
    def _shares(self) -> tuple[PointCovariances, PointCovariances]:
        noise, calibration = np.empty((2, len(self), 3, 3))
        for first in range(0, len(self), RUN):
            rows = np.arange(first, min(first + RUN, len(self)))
            errors = self.errors(rows)
            noise[rows] = errors.own + errors.by_shared @ errors.shared @ errors.by_shared.swapaxes(1, 2)
            carried = errors.by_cameras @ errors.cameras
            calibration[rows] = carried @ errors.by_cameras.swapaxes(1, 2)
        return noise, calibration

    @property
    def noise(self) -> PointCovariances:
        """The share of noise and of the bars' lengths in the covariance of each point, mm squared."""
        return self._shares[0]

    @property
    def calibration(self) -> PointCovariances:
        """The share of cameras and scale, (n, 3, 3), mm squared."""
        return self._shares[1]
