"""The frame that a user names, read from words such as ``points:origin,x,plane``."""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from scipy.linalg import block_diag

from labcal.arrays import AnyArray
from labcal.cameras.rig import Rig
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections_csv import read_detections
from labcal.correspond.named_points import NamedPoints
from labcal.errors import InputError, UnknownNameError
from labcal.estimators.model import Model
from labcal.reconstruct.frames.by_known import CameraShare, MeasuredKnown, frame_by_known
from labcal.reconstruct.frames.by_points import frame_by_points
from labcal.reconstruct.frames.fitted_frame import FittedFrame, FrameCalibration, FrameKind
from labcal.reconstruct.frames.known_points import read_known_points
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.reconstruct.scale.scaled_budget import ScaledBudget
from labcal.targets.board_set import BoardSet
from labcal.targets.target import Target
from labcal.wording import clipped, counted, listed, printable


@dataclass(frozen=True)
class RequestedFrame:
    """The words that name a frame, understood."""

    kind: FrameKind
    value: str
    """Names of three points with commas between them, or the path of a table."""
    view: str | None = None
    """The view whose points determine it; None for the only one that has them."""

    @classmethod
    def of(cls, words: str, view: str | None = None) -> "RequestedFrame":
        """Return the frame that words name.

        Parameters
        ----------
        words : str
            ``points:ORIGIN,ON-X,IN-PLANE``, ``board:detections.csv``, ``rigid:known.csv`` or
            ``similarity:known.csv``.
        view : str, optional

        Raises
        ------
        InputError
            They are none of these, or do not name three different points.
        """
        kind, colon, value = words.partition(":")
        if kind not in {one.value for one in FrameKind} or not colon or not value:
            raise InputError(
                f"'{clipped(printable(words))}' names no frame. Give `frame` as points:ORIGIN,ON-X,IN-PLANE "
                "(three names), board:detections.csv (of a target that lies in it), rigid:known.csv or "
                "similarity:known.csv (columns point, X_mm, Y_mm, Z_mm and, where known, sigma_mm)."
            )
        names = value.split(",")
        if kind == FrameKind.POINTS.value and not len(names) == len(set(names)) == 3:  # noqa: PLR2004 -- origin, on x, in the plane
            raise InputError(
                f"A frame by points takes three different names, with commas between them, but `frame` is "
                f"'{clipped(printable(words))}'. Give it as points:ORIGIN,ON-X,IN-PLANE."
            )
        return cls(FrameKind(kind), value, view)

    @property
    def path(self) -> Path | None:
        """The table that is read; None for three points."""
        return None if self.kind is FrameKind.POINTS else Path(self.value)

    def fitted(
        self,
        model: Model | Rig,
        points: NamedPoints,
        target: Target | None = None,
        budget: PointBudget | ScaledBudget | None = None,
    ) -> FittedFrame:
        """Return the frame in the world of a model.

        Parameters
        ----------
        model : Model or Rig
        points : NamedPoints
            In the world of the model, with the covariances of their noise.
        target : Target, optional
            The target that lies in the frame; of `BOARD` alone.
        budget : PointBudget or ScaledBudget, optional
            Of the points, line by line, if they are those of a rig.

        Raises
        ------
        InputError
            The points or dots that determine it are missing, or determine none.
        """
        if (target is None) == (self.kind is FrameKind.BOARD):
            if target is not None:
                raise InputError("`target` goes with a frame by a board that lies in it. Leave it out.")
            raise InputError("A frame by a board takes the board's name: `target='NAME'`.")
        if self.kind is FrameKind.POINTS:
            return self._by_points(points, budget)
        if target is not None:
            return self._by_board(model, target, None if budget is None else budget.kind)
        return self._by_known(points, budget)

    def _by_points(self, points: NamedPoints, budget: PointBudget | ScaledBudget | None) -> FittedFrame:
        names = tuple(self.value.split(","))
        for name in names:
            if name not in points.name:
                raise UnknownNameError("point", name, dict.fromkeys(points.name.tolist()))
        origin, on_x, in_plane = names
        rows = self._rows(points, names, least=len(names))
        ordered = [rows[name] for name in names]
        view = str(points.view[ordered[0]])
        frame = frame_by_points(
            view, (origin, on_x, in_plane), points.point[ordered], points.covariance[ordered]
        )
        share = _camera_share(budget, ordered)
        if share is None:
            return frame
        by_cameras = np.einsum("kpi,kic->pc", frame.slopes, share.by_cameras)
        frame = replace(frame, calibration=FrameCalibration(by_cameras, share.covariance))
        return _with_shared_errors(frame, budget, ordered)

    def _by_known(self, points: NamedPoints, budget: PointBudget | ScaledBudget | None) -> FittedFrame:
        known = read_known_points(Path(self.value))
        if len(known.name) < 3:  # noqa: PLR2004 -- fewer fix no frame
            raise InputError(
                f"A frame by known points takes three of them or more, not on one line, but {self.value} has "
                f"{counted(len(known.name), 'point')}."
            )
        rows = self._rows(points, known.name, least=3)
        at = [place for place, name in enumerate(known.name) if name in rows]
        names = tuple(known.name[place] for place in at)
        ordered = [rows[name] for name in names]
        given = MeasuredKnown(
            str(points.view[ordered[0]]),
            names,
            points.point[ordered],
            points.covariance[ordered],
            known.point[at],
            known.sigma_mm[at, None, None] ** 2 * np.eye(3),
            _camera_share(budget, ordered),
        )
        return _with_shared_errors(frame_by_known(self.kind, given), budget, ordered)

    def _by_board(self, model: Model | Rig, target: Target, wanted: Budget | None) -> FittedFrame:
        from labcal.reconstruct.reconstruction import reconstruct_centres  # noqa: PLC0415 -- a board alone needs it

        dots = read_detections(Path(self.value))
        if self.view is None and len(dots.views) > 1:
            raise InputError(
                f"{self.value} has dots of {len(dots.views)} views ({listed(dots.views)}). Name the one "
                "in which the board lies in the frame: `frame_view='VIEW'`."
            )
        view = self.view or next(iter(dots.views), "")
        if view not in dots.views:
            raise UnknownNameError("view in the detections", view, dots.views)
        if isinstance(target, BoardSet):  # its frame is that of the first board
            target = target.targets[0]
        dots = on_target(dots.where(dots.view == view), target)
        measured = reconstruct_centres(model, dots, target, wanted)
        lines = np.flatnonzero(measured.points.ok)
        found, share = measured.points.where(lines), _camera_share(measured.budget, lines)
        given = MeasuredKnown(
            view,
            tuple(f"dot ({col}, {row})" for col, row in found.index.tolist()),
            found.point,
            found.covariance if share is None or measured.budget is None else measured.budget.noise[lines],
            target.points(found.index),
            np.zeros((len(found), 3, 3)),
            share,
        )
        return frame_by_known(self.kind, given)

    def _rows(self, points: NamedPoints, names: tuple[str, ...], least: int) -> dict[str, int]:
        """Return the rows of points by their names, of the view that has enough of them.

        Raises
        ------
        InputError
            No view has, or several have and none is named.
        """
        there = np.isfinite(points.point).all(axis=1) & np.isfinite(points.covariance).all(axis=(1, 2))
        wanted = np.flatnonzero(there & np.isin(points.name, names))
        if self.view is not None:
            if self.view not in points.view:
                raise UnknownNameError("view in the pixels", self.view, dict.fromkeys(points.view.tolist()))
            wanted = wanted[points.view[wanted] == self.view]
        by_view: dict[str, dict[str, int]] = {}
        for row in wanted.tolist():
            by_view.setdefault(str(points.view[row]), {})[str(points.name[row])] = row
        fitting = {view: rows for view, rows in by_view.items() if len(rows) >= least}
        if len(fitting) > 1:
            raise InputError(
                f"The points of the frame were measured in {len(fitting)} views ({listed(fitting)}). Name "
                "the one that determines it: `frame_view='VIEW'`."
            )
        if not fitting:
            raise InputError(
                f"No view has a place, with a covariance, for {least} of the points {listed(names)} of the "
                "frame. See the flags of these points, or name others."
            )
        return next(iter(fitting.values()))


def _camera_share(budget: PointBudget | ScaledBudget | None, lines: AnyArray) -> CameraShare | None:
    """Return the cameras' share in the errors of some points; None where cameras count as exact."""
    if isinstance(budget, ScaledBudget):
        errors = budget.errors(lines)
        return CameraShare(errors.by_cameras, errors.cameras)
    if budget is None or budget.kind is Budget.NOISE:
        return None
    return CameraShare(budget.derivatives(lines), budget.parameters)


def _with_shared_errors(
    frame: FittedFrame, budget: PointBudget | ScaledBudget | None, lines: AnyArray
) -> FittedFrame:
    """Return a frame with all that its points share after scale bars among what all points share.

    Bars leave the noise of their ends and their own lengths in every point, and so in the points of a frame.
    """
    if not isinstance(budget, ScaledBudget):
        return frame
    errors = budget.errors(lines)
    by = np.concatenate([errors.by_cameras, errors.by_shared], axis=2)
    common = FrameCalibration(
        np.einsum("kpi,kic->pc", frame.slopes, by), np.asarray(block_diag(errors.cameras, errors.shared))
    )
    return replace(frame, covariance=errors.own, calibration=common)
