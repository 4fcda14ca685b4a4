"""The error budget of named points in a frame that measured points determine."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import block_diag

from labcal.arrays import AnyArray, PointCovariances, lines_array
from labcal.cameras.derivatives import RUN
from labcal.correspond.named_points import NamedPoints
from labcal.reconstruct.frames.fitted_frame import FREE, FittedFrame, FrameKind, by_parameters
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.point_errors import PointErrors
from labcal.reconstruct.scale.scaled_budget import ScaledBudget


@dataclass(frozen=True, eq=False)
class FramedBudget:
    """Both shares of the errors of points of one rig, in a frame b that errs with the points that fix it.

    The calibration moves a point and the points of the frame alike, so that much of its share cancels.

    Attributes
    ----------
    world : PointBudget or ScaledBudget
        In the world of the rig, a; after scale bars, if there were any.
    points : NamedPoints
        In a; with the covariances of their noise.
    frame : FittedFrame
        Of b.
    noise : float64 array, (n, 3, 3)
        Share of noise and of the known coordinates of the frame, in b, mm squared.
    """

    world: PointBudget | ScaledBudget
    points: NamedPoints
    frame: FittedFrame
    noise: PointCovariances

    @property
    def kind(self) -> Budget:
        """The sources of errors that it holds."""
        return self.world.kind

    def __len__(self) -> int:
        return len(self.points)

    @cached_property
    def calibration(self) -> PointCovariances:
        """The share of the calibration in the covariance of each point, (n, 3, 3), mm squared."""
        share = np.zeros_like(self.noise)
        if self.kind is Budget.NOISE and isinstance(self.world, PointBudget):
            return share
        for first in range(0, len(self), RUN):
            lines = np.arange(first, min(first + RUN, len(self)))
            errors = self.errors(lines)
            by = errors.by_cameras
            carried = (by.reshape(-1, by.shape[2]) @ errors.cameras).reshape(by.shape)
            share[lines] = carried @ by.transpose(0, 2, 1)
        return share

    @property
    def whole_noise(self) -> PointCovariances:
        """The share of all that is no error of the cameras, also what points share by scale bars."""
        found = np.empty_like(self.noise)
        for first in range(0, len(self), RUN):
            lines = np.arange(first, min(first + RUN, len(self)))
            errors = self.errors(lines)
            found[lines] = errors.own + errors.by_shared @ errors.shared @ errors.by_shared.swapaxes(1, 2)
        return found

    def errors(self, lines: AnyArray) -> PointErrors:
        """Return the sources of the errors of some points: their numbers, or a mask."""
        numbers = np.arange(len(self))[lines_array(lines, len(self), "lines")]
        inside, frame = self.world.errors(numbers), self.frame
        by_point = frame.scale * frame.R_ba
        by_frame = by_parameters(self.points.point[numbers] @ by_point.T, frame.slopes.shape[1])
        by_parameter, shared, stated = frame.shared_errors
        own = by_point @ inside.own @ by_point.T
        by_shared, cameras = by_frame @ by_parameter, inside.by_cameras.shape[2]
        by_others = by_point @ np.concatenate([inside.by_cameras, inside.by_shared], axis=2)
        if frame.calibration is not None:
            by_others += by_frame @ frame.calibration.by_cameras
        place = dict(self._own_places)
        for row, line in enumerate(numbers.tolist()):
            if line not in place:
                continue
            at = place[line]
            own[row] = 0.0  # its noise is among the shared errors
            by_shared[row][:, 3 * at : 3 * at + 3] += by_point
            if frame.kind is FrameKind.POINTS:  # but for rounding
                by_shared[row] *= FREE[at, :, None]
                by_others[row] *= FREE[at, :, None]
        return PointErrors(
            own,
            np.concatenate([by_shared, by_others[:, :, cameras:]], axis=2),
            np.asarray(block_diag(shared, inside.shared)) if len(inside.shared) else shared,
            np.concatenate([stated, inside.stated]),
            by_others[:, :, :cameras],
            inside.cameras,
        )

    @cached_property
    def _own_places(self) -> list[tuple[int, int]]:
        return self.frame.own_rows(self.points)
