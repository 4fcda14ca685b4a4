"""Figures of several cases together: medians of what is known, and coverage of all their points."""

from collections.abc import Iterable, Sequence

import numpy as np

from labcal.bench.distortion.figures import RegionFigures


def known_median(values: Sequence[float]) -> float:
    """Return the median of the finite values; NaN of none.

    Parameters
    ----------
    values : sequence of float
    """
    known = [value for value in values if np.isfinite(value)]
    return float(np.median(known)) if known else float("nan")


def pooled_coverage(figures: Iterable[RegionFigures | None]) -> float:
    """Return the coverage of the points of all figures together; NaN where no covariance is stated.

    Parameters
    ----------
    figures : iterable of RegionFigures or None
        None counts for no points.
    """
    known = [one for one in figures if one is not None]
    stated = sum(one.stated for one in known)
    return sum(one.covered for one in known) / stated if stated else float("nan")
