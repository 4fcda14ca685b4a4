"""Readings of the error that the paper prints for rows 17 to 23."""

from enum import StrEnum


class FigureReading(StrEnum):
    """The quantity that the printed figure may be."""

    MEAN_SIGNED = "mean signed error"
    """As everywhere else: the mean over all points and coordinates, with signs."""
    COORDINATE = "RMS error of a coordinate"
    """About the error of a single point that is looked at."""
