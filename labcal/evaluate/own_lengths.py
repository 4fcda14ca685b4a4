"""Errors of reconstructed points against the target's own lengths, for shoots without a truth."""

from collections.abc import Collection
from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist

from labcal.correspond.matching import rows_by_name
from labcal.correspond.points import PointFlag, Points
from labcal.errors import InputError
from labcal.evaluate.scored_views import ScoredViews, scored_warnings
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target


@dataclass(frozen=True)
class LengthError:
    """Measured minus nominal length (VDI/VDE 2634 part 1), mm."""

    max: float
    """Greatest absolute value."""
    rms: float
    """Root mean square."""


@dataclass(frozen=True)
class LengthErrors:
    """The JSON document of ``labcal evaluate`` where the truth is not known."""

    n: int
    """Number of lengths that were compared."""
    length_error_mm: LengthError
    epipolar_rms_px: float
    """NaN: it cannot be computed from points; see ``labcal calibrate``."""
    scale_ppm: float
    """Scale error of the reconstruction, parts per million, from a least-squares fit of lengths."""
    n_ok: int
    """Number of scored points that are flagged ``ok``."""
    views_scored: tuple[str, ...]
    views_calibrated_on: int | None
    """Number of scored views that the cameras were calibrated from; None if not known."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings in words."""
        return scored_warnings(self.n_ok, self.views_calibrated_on)


def errors_of_lengths(
    points: Points, target: Target | DotPlaces, learned: Collection[str] | None = None
) -> LengthErrors:
    """Compare the distance of every two dots of a view with their distance on the target.

    Parameters
    ----------
    points : Points
    target : Target or DotPlaces
        Its dots are taken as exactly placed: where they were declared, or where they were found to be. Of
        places, only those that were found count.
    learned : collection of str, optional
        Names of the views that were learned from: where there are others, only these count. Where left out,
        those that determined the places.

    Raises
    ------
    InputError
        No view has two points that count, or there is a point of a dot that the target does not have.
    """
    declared = target.target if isinstance(target, DotPlaces) else target
    _require_dots(points, declared)
    places = target.points()
    numbers = points.index[:, 1] * declared.cols + points.index[:, 0]
    counted = np.isfinite(points.point).all(axis=1)
    if isinstance(target, DotPlaces):
        counted &= target.freed()[numbers]
        learned = learned or target.calibrated_on or None
    scored = ScoredViews.of(points.view, learned)
    counted &= scored.holds(points.view)
    measured, nominal = [], []
    for lines in rows_by_name(points.view).values():
        rows = lines[counted[lines]]
        if len(rows) == 0:
            continue
        measured.append(pdist(points.point[rows]))
        nominal.append(pdist(places[numbers[rows]]))
    lengths = np.concatenate(measured) if measured else np.zeros(0)
    if len(lengths) == 0:
        raise InputError(
            "There are no two points of the same view whose places are known, so no length can be compared."
        )
    expected = np.concatenate(nominal)
    error = lengths - expected
    return LengthErrors(
        n=len(error),
        length_error_mm=LengthError(max=float(np.abs(error).max()), rms=float(np.sqrt((error**2).mean()))),
        epipolar_rms_px=float("nan"),
        scale_ppm=float(1e6 * ((lengths @ expected) / (expected @ expected) - 1.0)),
        n_ok=int((points.flag[counted] == PointFlag.OK.value).sum()),
        views_scored=tuple(dict.fromkeys(points.view[counted].tolist())),
        views_calibrated_on=scored.calibrated_on,
    )


def _require_dots(points: Points, target: Target) -> None:
    """Raise unless every point is of a dot of the target."""
    unknown = ((points.index < 0) | (points.index >= [target.cols, target.rows])).any(axis=1)
    if unknown.any():
        col, row = points.index[np.argmax(unknown)].tolist()
        raise InputError(
            f"There is a point of dot ({col}, {row}), but '{target.name}' has {target.cols} x {target.rows} "
            "dots. Name the target that the points are of."
        )
