"""Comparison of triangulation residuals with those of the calibration."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.triangulation_residuals import TriangulationResiduals
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.correspond.matching import Matches, rows_by_name
from labcal.distributions import chi2_quantile

UNKNOWN_SCATTER_PX = 0.35
"""Along each axis, of cameras that do not say what their calibration left: older rigs, other programs'."""
LEAST_SCATTER_PX = 0.01
"""Along each axis: a calibration may do better in its own views, but that is beneath notice elsewhere."""
_TIMES, _TIMES_IN_VIEW = 2.0, 4.0
"""Times the expected variance from which on all views (but for odd ones), or one, are inconsistent.

Measured on rigs of 8 views that were tried on the views of other sets: at most 1.2 and 2.8.
"""
_FEWEST = 20
"""Dots of a view that is judged by itself."""


@dataclass(frozen=True)
class TriangulationCheck:
    """The triangulation residual of points, and its expectation from the calibration."""

    rms_px: float
    """Root mean square of the 2-D reprojection error over cameras and points; NaN where no rays meet."""
    expected_px: float
    """Expected value by the noise of pixels and the variance component of the calibration."""
    assumed: bool
    """True if the variance component is not stated, and :data:`UNKNOWN_SCATTER_PX` is assumed."""
    inconsistent: bool
    """True if the residual is far larger than expected in all views, or in those not listed in `views`."""
    views: tuple[str, ...]
    """Views in which it is."""

    @classmethod
    def of(
        cls, residuals: TriangulationResiduals, matches: Matches, calibration: CalibrationRecord | None
    ) -> "TriangulationCheck":
        """Compare the residuals of matched dots with their expectation."""
        expected = _expected(matches, scatter_of(calibration))
        compared = _Compared(residuals.px, expected, _times(residuals, expected), matches.view)
        return cls._by(compared, calibration, lambda _: True)

    @classmethod
    def of_groups(
        cls,
        groups: Sequence[tuple[TriangulationResiduals, Matches]],
        calibration: CalibrationRecord | None,
        beyond_chance: Callable[[Int64[np.ndarray, " rows"]], bool],
    ) -> "TriangulationCheck":
        """Compare the residuals of points that different cameras see.

        Parameters
        ----------
        groups : sequence of (TriangulationResiduals, Matches)
            For each set of cameras, weighed by pixels that scatter by the calibration, too.
        calibration : CalibrationRecord or None
        beyond_chance : callable
            Tells of numbers of points, group after group, whether residuals as large as theirs are beyond
            chance: those of a few points are by chance twice as large as expected.
        """
        scatter = scatter_of(calibration)
        compared = _Compared(
            np.concatenate([residuals.px for residuals, _ in groups]),
            np.concatenate([_expected(matches, scatter) for _, matches in groups]),
            np.concatenate([of.chi_square / chi2_quantile(0.5, of.freedom) for of, _ in groups]),
            np.concatenate([matches.view for _, matches in groups]),
        )
        return cls._by(compared, calibration, beyond_chance)

    @classmethod
    def _by(
        cls,
        compared: "_Compared",
        calibration: CalibrationRecord | None,
        beyond_chance: Callable[[Int64[np.ndarray, " rows"]], bool],
    ) -> "TriangulationCheck":
        px, times, view = compared.px, compared.times, compared.view
        finite = np.isfinite(px)
        square = float((px[finite] ** 2).mean()) if finite.any() else float("nan")
        by_view = rows_by_name(view)
        off = [
            name
            for name, rows in by_view.items()
            if len(rows) >= _FEWEST and float(np.median(times[rows])) > _TIMES_IN_VIEW and beyond_chance(rows)
        ]
        rest = np.flatnonzero(~np.isin(view, off))
        inconsistent = len(view) > 0
        if len(rest):
            inconsistent = float(np.median(times[rest])) > _TIMES and beyond_chance(rest)
        views = tuple(by_view) if inconsistent else tuple(off)
        assumed = calibration is None or calibration.scatter_px is None
        return cls(np.sqrt(square), float(np.sqrt(compared.expected.mean())), assumed, inconsistent, views)


@dataclass(frozen=True)
class _Compared:
    """Residuals and their expectation, by point."""

    px: Float64[np.ndarray, " n"]
    expected: Float64[np.ndarray, " n"]
    """Of their squares, px squared."""
    times: Float64[np.ndarray, " n"]
    """Squares over their median by chance."""
    view: np.ndarray
    """(n,) of str"""


def scatter_of(calibration: CalibrationRecord | None) -> float:
    """Return what a calibration adds to the noise of pixels along each axis, px; assumed if not known."""
    if calibration is None or calibration.scatter_px is None:
        return UNKNOWN_SCATTER_PX
    return max(LEAST_SCATTER_PX, calibration.scatter_px)


def calibration_record(
    cameras: Sequence[Camera], matches: Matches, causes: tuple[str, ...] = ()
) -> CalibrationRecord:
    """Return the record of triangulation residuals after a calibration from these dots.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of the matches.
    matches : Matches
        Images of dots' centres.
    causes : tuple of str
        Why the calibration is inconsistent, the likeliest first; none where it is not.
    """
    if len(cameras) < 2 or len(matches) == 0:  # noqa: PLR2004 -- rays of one camera do not meet
        return CalibrationRecord(inconsistent=causes)
    residuals = TriangulationResiduals.of(cameras, matches)
    finite = np.isfinite(residuals.px)
    if not finite.any():
        return CalibrationRecord(inconsistent=causes)
    share = residuals.freedom / len(cameras)
    usual = (
        float(np.median(residuals.px**2)) * residuals.freedom / chi2_quantile(0.5, residuals.freedom) / share
    )
    noise = float(np.median(_variance(matches)))
    return CalibrationRecord(
        triangulation_rms_px=float(np.sqrt((residuals.px[finite] ** 2).mean())),
        scatter_px=float(np.sqrt(max(0.0, usual - noise))) if np.isfinite(usual) else None,
        inconsistent=causes,
    )


def _variance(matches: Matches) -> Float64[np.ndarray, " n"]:
    """Return the variance of pixels along an axis by their covariances, mean over cameras, px squared."""
    return np.asarray(np.trace(matches.covariance, axis1=2, axis2=3).mean(axis=1) / 2.0)


def _expected(matches: Matches, scatter_px: float) -> Float64[np.ndarray, " n"]:
    """Return the expected square of the residuals, px squared: of 2 c components 2 c - 3 are left."""
    cameras = len(matches.cameras)
    variance = _variance(matches)
    noise = np.where(np.isfinite(variance), variance, 0.0)
    return np.asarray((2 * cameras - 3) / cameras * (noise + scatter_px**2))


def _times(
    residuals: TriangulationResiduals, expected: Float64[np.ndarray, " n"]
) -> Float64[np.ndarray, " n"]:
    """Return how many times the median of its expectation the square of each residual is."""
    usual = chi2_quantile(0.5, residuals.freedom) / residuals.freedom
    return np.asarray(residuals.px**2 / expected / usual)
