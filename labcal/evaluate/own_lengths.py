"""Errors of reconstructed points against the target's own lengths, for shoots without a truth."""

from dataclasses import dataclass

import numpy as np
from scipy.spatial.distance import pdist

from labcal.correspond.points import ReconstructedPoints
from labcal.errors import InputError
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
    """How many lengths were compared."""
    length_error_mm: LengthError
    epipolar_rms_px: float
    """NaN: points alone do not tell it; ``labcal calibrate`` does."""
    scale_ppm: float
    """By how much the reconstruction is too large, parts per million, from a least-squares fit of lengths."""


def errors_of_lengths(points: ReconstructedPoints, target: Target) -> LengthErrors:
    """Compare the distance of every two dots of a view with their distance on the target.

    Parameters
    ----------
    points : ReconstructedPoints
    target : Target
        Its dots are taken as exactly placed.

    Raises
    ------
    InputError
        No view has two points.
    """
    solved = points.where(np.isfinite(points.point).all(axis=1))
    measured, nominal = [], []
    for view in dict.fromkeys(solved.view.tolist()):
        of_view = solved.where(solved.view == view)
        measured.append(pdist(of_view.point))
        nominal.append(pdist(target.points(of_view.index)))
    lengths = np.concatenate(measured) if measured else np.zeros(0)
    if len(lengths) == 0:
        raise InputError("There are no two points of the same view, so there is no length to compare.")
    expected = np.concatenate(nominal)
    error = lengths - expected
    return LengthErrors(
        n=len(error),
        length_error_mm=LengthError(max=float(np.abs(error).max()), rms=float(np.sqrt((error**2).mean()))),
        epipolar_rms_px=float("nan"),
        scale_ppm=float(1e6 * ((lengths @ expected) / (expected @ expected) - 1.0)),
    )
