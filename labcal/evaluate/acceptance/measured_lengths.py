"""Lengths as measured, with the shares of their uncertainty."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag, Points
from labcal.errors import InputError
from labcal.evaluate.acceptance.reference_lengths import ReferenceLengths
from labcal.reconstruct.distance import distance
from labcal.reconstruct.named_reconstruction import NamedReconstruction
from labcal.reconstruct.point_budget import Budget
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.wording import clipped, counted, printable

AnyPoints = Points | NamedPoints | Reconstruction | NamedReconstruction


@dataclass(frozen=True)
class MeasuredLengths:
    """Measured lengths in the order of their references.

    Attributes
    ----------
    length_mm : float64 array, (n,)
        NaN where an end was not measured.
    noise_sigma_mm : float64 array, (n,)
        Standard deviation by the noise of the pixels; NaN where points state no covariance. Of a table of
        points, by all that their covariances hold.
    calibration_sigma_mm : float64 array, (n,)
        By the errors of the calibration, and of scale bars; NaN where that is not known.
    missing : tuple of str
        Reasons why lengths were not measured.
    warnings : tuple of str
    """

    length_mm: Float64[np.ndarray, " n"]
    noise_sigma_mm: Float64[np.ndarray, " n"]
    calibration_sigma_mm: Float64[np.ndarray, " n"]
    missing: tuple[str, ...]
    warnings: tuple[str, ...]


def measured_lengths(given: AnyPoints, lengths: ReferenceLengths) -> MeasuredLengths:
    """Return the distances between the ends of known lengths.

    Parameters
    ----------
    given : Points, NamedPoints, Reconstruction or NamedReconstruction
        Points of one rig or method; dots of a target are named ``col:row``.
    lengths : ReferenceLengths

    Raises
    ------
    InputError
        None of the lengths has both ends among the points.
    """
    points = given if isinstance(given, Points | NamedPoints) else given.points
    ends, missing = _ends(points, lengths)
    found = np.full((3, len(lengths)), np.nan)
    measured = np.flatnonzero((ends >= 0).all(axis=1))
    if len(measured) == 0:
        raise InputError(
            f"Not one of {counted(len(lengths), 'length')} was measured: {missing[0]}. Take views and points "
            "as they are named in the table of points; a dot of a target is named col:row, as in 3:4, one of "
            "several boards board-a:3:4."
        )
    for number in measured.tolist():
        found[:, number] = _length(given, points, *ends[number].tolist())
    length, noise, calibration = found
    warnings = tuple(_warnings(given, points, ends[measured]))
    return MeasuredLengths(length, noise, calibration, tuple(missing), warnings)


def _ends(points: Points | NamedPoints, lengths: ReferenceLengths) -> tuple[np.ndarray, list[str]]:
    """Return the lines of the ends of each length, -1 where one was not measured, and reasons."""
    names = points.name.tolist() if isinstance(points, NamedPoints) else _dot_names(points)
    known = {key: line for line, key in enumerate(zip(points.view.tolist(), names, strict=True))}
    there = np.isfinite(points.point).all(axis=1)
    ends, missing = np.full((len(lengths), 2), -1), []
    for number in range(len(lengths)):
        title = f"length '{lengths.length[number]}' of line '{lengths.line[number]}'"
        pairs = (
            (str(lengths.view_a[number]), str(lengths.point_a[number])),
            (str(lengths.view_b[number]), str(lengths.point_b[number])),
        )
        for end, (view, name) in enumerate(pairs):
            line = known.get((view, name))
            if line is not None and there[line]:
                ends[number, end] = line
                continue
            why = "is not among the points" if line is None else f"has no place ({points.flag[line]})"
            missing.append(
                f"{title}: '{clipped(printable(name))}' of view '{clipped(printable(view))}' {why}"
            )
    return ends, missing


def _dot_names(points: Points) -> list[str]:
    names = [f"{col}:{row}" for col, row in points.index.tolist()]
    boards = points.board.tolist()
    return [f"{board}:{name}" if board else name for board, name in zip(boards, names, strict=True)]


def _length(
    given: AnyPoints, points: Points | NamedPoints, one: int, other: int
) -> tuple[float, float, float]:
    """Return a length and its standard deviations by noise and by the calibration, mm."""
    along = points.point[other] - points.point[one]
    length = float(np.linalg.norm(along))
    if length == 0.0:
        return 0.0, float("nan"), float("nan")
    if isinstance(given, Reconstruction | NamedReconstruction) and given.budget is not None:
        found = distance(given, one, other)
        shared = float(np.sqrt(max(0.0, found.sigma**2 - found.noise_sigma**2)))
        return found.value, found.noise_sigma, shared if found.budget is Budget.FULL else float("nan")
    unit = along / length
    covariance = points.covariance[one] + points.covariance[other]
    return length, float(np.sqrt(unit @ covariance @ unit)), float("nan")


def _warnings(given: AnyPoints, points: Points | NamedPoints, ends: np.ndarray) -> list[str]:
    """Return what a reader of a certificate should know of the points."""
    found = []
    flags = points.flag[np.unique(ends)]
    unusual = sorted({str(flag) for flag in flags if flag != PointFlag.OK.value})
    if unusual:
        count = int((flags != PointFlag.OK.value).sum())
        found.append(
            f"{counted(count, 'end')} of lengths flagged {', '.join(unusual)}: they count as measured"
        )
    if not np.isfinite(points.covariance[np.unique(ends)]).all():
        found.append("some points state no covariance: their noise is not in the uncertainty of the test")
    if isinstance(given, Points | NamedPoints):
        found.append(
            "covariances of a table of points do not tell noise from errors of the calibration, and both "
            "count as noise of the test. Give the rig and the pixels to tell them apart"
        )
    return found
