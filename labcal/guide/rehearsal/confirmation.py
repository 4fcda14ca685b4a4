"""The confirmation of a forecast: errors found in rendered pictures beside those that were foretold."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import PointCovariances, Vectors3
from labcal.guide.rehearsal.error_scatter import WITHIN, ErrorScatter
from labcal.rng import generator

_RANKS, _LOWEST = 200, 5.0
"""Rank correlations that are drawn, and the percentile of the lowest one to expect."""
GROUPS = 20
"""Groups of points with about the same foretold error, whose RMS errors are compared."""


@dataclass(frozen=True)
class FoundError:
    """An RMS 3-D error over all rendered sets, found and foretold.

    Attributes
    ----------
    rms_mm, expected_mm : float
    lowest_mm, highest_mm : float
        Range of the RMS error over so many calibrations, in 95 of 100.
    by_set_mm : tuple of float
        RMS error of each set.
    sets_needed : int
        Fewest sets whose RMS error is within 15% of the expected one in 95 of 100.
    relative_sigma : float
        Standard deviation of the mean square over all sets, over its expectation.
    """

    rms_mm: float
    expected_mm: float
    lowest_mm: float
    highest_mm: float
    by_set_mm: tuple[float, ...]
    sets_needed: int
    relative_sigma: float

    @classmethod
    def of(cls, square_mm2: Float64[np.ndarray, "sets n"], scatter: ErrorScatter) -> "FoundError":
        """Return the error that squared errors of points show.

        Parameters
        ----------
        square_mm2 : ndarray, shape (sets, n)
            NaN where a point was not measured.
        scatter : ErrorScatter
            Of the same points.
        """
        low, high = scatter.range_mm if len(square_mm2) == 1 else scatter.range_of_mean(len(square_mm2))
        by_set = np.nanmean(square_mm2, axis=1)
        return cls(
            rms_mm=float(np.sqrt(by_set.mean())),
            expected_mm=scatter.rms_mm,
            lowest_mm=low,
            highest_mm=high,
            by_set_mm=tuple(np.sqrt(by_set).tolist()),
            sets_needed=scatter.sets_needed,
            relative_sigma=scatter.relative_sigma / float(np.sqrt(len(square_mm2))),
        )

    @property
    def ratio(self) -> float:
        """The error found over the foretold one."""
        return self.rms_mm / self.expected_mm

    @property
    def allowed(self) -> float:
        """Deviation of that ratio from 1 that counts as foretold: 15%, or more where chance makes more."""
        by_chance = self.lowest_mm if self.ratio < 1.0 else self.highest_mm
        return max(WITHIN, abs(by_chance / self.expected_mm - 1.0))

    @property
    def holds(self) -> bool:
        """True if the error found is within 15% of the foretold one, or within what chance makes of it."""
        return abs(self.ratio - 1.0) <= self.allowed


@dataclass(frozen=True)
class Confirmation:
    """Errors of a rendered rig, found and foretold.

    Attributes
    ----------
    sets : int
        Shoots that were rendered, each with a print and with noise of its own, and calibrated.
    views, points : int
        Views that calibrated each, and points of further views that were measured.
    freed : int
        Sets whose calibration freed the dots.
    renderer_px : float
        Standard deviation of a coordinate of a dot by the renderer's finitely many rays; it is in what is
        foretold here, and in no camera.
    dot_rms_px, dot_expected_px : float
        RMS error of a coordinate of measured dots, and the foretold one of dots of their sizes.
    places : FoundError
        Of points in the frame of the first camera.
    shape : FoundError
        Of what a rigid alignment of all points of a set onto the truth leaves.
    map_rank : float
        Rank correlation of the map of errors of shape, found and foretold, in groups of points.
    map_rank_lowest : float
        That which a true forecast exceeds in 95 of 100, by the noise of so many points: little where errors
        are nearly the same all over the volume.
    """

    sets: int
    views: int
    points: int
    freed: int
    renderer_px: float
    dot_rms_px: float
    dot_expected_px: float
    places: FoundError
    shape: FoundError
    map_rank: float
    map_rank_lowest: float

    @property
    def holds(self) -> bool:
        """True if both errors are as foretold, up to 15% or to what chance makes of so many sets."""
        return self.places.holds and self.shape.holds


def squares(error: Vectors3) -> Float64[np.ndarray, " n"]:
    """Return squared lengths of errors."""
    return np.asarray((error**2).sum(axis=-1))


def rms_coordinate(error: Float64[np.ndarray, "n 2"]) -> float:
    """Return the root mean square of errors of coordinates."""
    return float(np.sqrt((error**2).mean()))


def group_rank(square_mm2: Float64[np.ndarray, "sets n"], expected_mm2: Float64[np.ndarray, " n"]) -> float:
    """Return the rank correlation of found and foretold errors in groups of points.

    One point tells nothing, since its error is a draw; points with about the same foretold error do.

    Parameters
    ----------
    square_mm2 : ndarray, shape (sets, n)
        Squared errors; NaN where a point was not measured.
    expected_mm2 : ndarray, shape (n,)
        Their foretold mean squares.
    """
    from scipy.stats import spearmanr  # noqa: PLC0415 -- takes a second to import

    order = np.argsort(expected_mm2, kind="stable")
    groups = [part for part in np.array_split(order, GROUPS) if len(part)]
    found = [float(np.nanmean(square_mm2[:, part])) for part in groups]
    return float(spearmanr(found, [float(expected_mm2[part].mean()) for part in groups]).statistic)


def lowest_rank(covariance: PointCovariances, sets: int) -> float:
    """Return the rank correlation that a true forecast exceeds in 95 of 100.

    Parameters
    ----------
    covariance : ndarray, shape (n, 3, 3)
        Of the errors of points, mm squared.
    sets : int
        Times that each is measured.
    """
    random = generator(0, "rehearsal", "rank")
    variance, axes = np.linalg.eigvalsh(covariance), (sets, len(covariance), 3)
    expected = variance.sum(axis=1)
    found = [
        group_rank((random.standard_normal(axes) ** 2 * variance).sum(axis=2), expected)
        for _ in range(_RANKS)
    ]
    return float(np.percentile(found, _LOWEST))
