"""Errors of reconstructed points against the target's own lengths, for shoots without a truth."""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from scipy.spatial.distance import pdist

from labcal.arrays import Lengths
from labcal.correspond.matching import rows_by_name
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.evaluate.scored_views import OfScoredViews, ScoredPart, ScoredViews
from labcal.run.json_text import IN_JSON, InJson
from labcal.targets.places import DotPlaces
from labcal.targets.target import Target

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas


@dataclass(frozen=True)
class LengthError:
    """Measured minus nominal length (VDI/VDE 2634 part 1), mm."""

    max: float
    """Greatest absolute value."""
    rms: float
    """Root mean square."""


@dataclass(frozen=True, eq=False, repr=False)
class LengthErrors(OfScoredViews):
    """The JSON document of ``labcal evaluate`` where the truth is not known.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> errors = pipeline.evaluate(examples.points(), examples.TARGET)
    >>> errors
    LengthErrors(n=30624, rms=0.0431 mm, max=0.332 mm, scale=-2.8 ppm)
    >>> errors.error.shape
    (30624,)
    """

    n: int
    """Number of lengths that were compared."""
    length_error_mm: LengthError
    epipolar_rms_px: float
    """NaN: it cannot be computed from points; see ``labcal calibrate``."""
    scale_ppm: float
    """By how much the reconstruction is too large, parts per million, from a least-squares fit of lengths."""
    scored_views: ScoredPart = field(metadata={IN_JSON: InJson.FLAT})
    """The views that are scored; its fields are also those of the errors."""
    error: Lengths = field(metadata={IN_JSON: InJson.ABSENT})
    """Measured minus nominal of each length, mm; not in the JSON document."""

    @property
    def warnings(self) -> tuple[str, ...]:
        """Warnings, for people."""
        if self.views_calibrated_on is not None:
            return super().warnings
        unknown = (
            "it is not known which views the cameras were calibrated from: in these the target's own lengths "
            "are no proof of anything. State what the points were reconstructed with: `rig`"
        )
        return (*super().warnings, unknown)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each length: measured minus nominal, ``error_mm``.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        from labcal.evaluate.error_tables import length_errors_frame  # noqa: PLC0415 -- pandas is optional

        return length_errors_frame(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw a histogram of the errors of lengths, with their RMS to both sides, mm.

        Examples
        --------
        >>> from labcal import examples, pipeline
        >>> errors = pipeline.evaluate(examples.points(), examples.TARGET)
        >>> errors.plot().axes[0].get_xlabel()
        'measured minus nominal length (mm)'
        """
        from labcal.evaluate.error_figure import error_figure  # noqa: PLC0415 -- imports matplotlib

        rms = self.length_error_mm.rms
        return error_figure(
            self.error, "measured minus nominal length (mm)", "lengths", {"RMS": rms, "minus RMS": -rms}
        )

    def _summary(self) -> Mapping[str, object]:
        return {
            "n": self.n,
            "rms": f"{self.length_error_mm.rms:.3g} mm",
            "max": f"{self.length_error_mm.max:.3g} mm",
            "scale": f"{self.scale_ppm:+.1f} ppm",
        }


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
        scored_views=ScoredPart.of(points.where(counted), scored),
        error=error,
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
