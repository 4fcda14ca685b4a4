"""The rule by which a row of the paper gets its verdict."""

from labcal.paper.rows import PaperRow
from labcal.report.reproduction import Figures
from labcal.report.row_verdict import EPOCH_FACTOR, RowVerdict

HALF_DIGIT_M = 0.5e-5
"""Half of the last digit of the paper's errors, which have five decimals."""


def row_verdict(row: PaperRow, ours: Figures) -> RowVerdict:
    """Return the verdict on a row.

    Parameters
    ----------
    row : PaperRow
    ours : Figures
        Of the reading that stands for the row.
    """
    if row.contradiction is not None:
        return RowVerdict.CONTRADICTION
    low, high = ours.mean_signed_range_m
    if low - HALF_DIGIT_M <= row.paper_abs_m <= high + HALF_DIGIT_M:
        return RowVerdict.MATCHES if _same_epochs(row, ours) else RowVerdict.OTHER_EPOCHS
    smaller = abs(ours.mean_signed_m) < abs(row.paper_abs_m)
    return RowVerdict.SMALLER if smaller else RowVerdict.LARGER


def _same_epochs(row: PaperRow, ours: Figures) -> bool:
    """Return whether the paper's epochs are ours; true where there are none."""
    if row.paper_epochs is None or ours.epochs is None or ours.epochs_range is None:
        return True
    low, high = ours.epochs_range
    within_range = low <= row.paper_epochs <= high
    return within_range or row.paper_epochs / EPOCH_FACTOR <= ours.epochs <= row.paper_epochs * EPOCH_FACTOR
