"""Errors as tables of pandas."""

from typing import TYPE_CHECKING

from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.own_lengths import LengthErrors
from labcal.extras import optional_module

if TYPE_CHECKING:
    import pandas


def truth_errors_frame(errors: TruthErrors) -> "pandas.DataFrame":
    """Return a line a point; see :meth:`TruthErrors.to_pandas`."""
    points = errors.points
    columns = ("view", "col", "row", "X_error_mm", "Y_error_mm", "Z_error_mm", "flag")
    values = (points.view, *points.index.T, *errors.error.T, points.flag)
    board = {"board": points.board} if points.boards else {}
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
        {**dict(zip(columns, values, strict=True)), **board}
    )
    return frame


def length_errors_frame(errors: LengthErrors) -> "pandas.DataFrame":
    """Return a line a length; see :meth:`LengthErrors.to_pandas`."""
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame({"error_mm": errors.error})
    return frame
