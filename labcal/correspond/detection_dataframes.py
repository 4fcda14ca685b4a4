"""Detections as a table of pandas, and as arrays of xarray."""

from typing import TYPE_CHECKING

import numpy as np

from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import BOARD, HEADER
from labcal.correspond.dot_axis import DotAxis
from labcal.errors import InputError
from labcal.extras import optional_module
from labcal.wording import listed

if TYPE_CHECKING:
    import pandas
    import xarray


def detections_frame(table: Detections) -> "pandas.DataFrame":
    """Return the columns of ``detections.csv``; see :meth:`Detections.to_pandas`."""
    library = optional_module("pandas", "data")
    col, row = (library.array(place, dtype="Int64") for place in table.index.T)
    col[~table.has_id] = row[~table.has_id] = library.NA
    columns = (
        table.view, table.camera, table.image, *table.size.T, col, row, *table.position.T,
        table.covariance[:, 0, 0], table.covariance[:, 0, 1], table.covariance[:, 1, 1], table.flag,
    )  # fmt: skip
    board = {BOARD: table.board} if table.boards else {}
    frame: pandas.DataFrame = library.DataFrame({**dict(zip(HEADER, columns, strict=True)), **board})
    return frame


def detections_dataset(table: Detections) -> "xarray.Dataset":
    """Return named arrays; see :meth:`Detections.to_xarray`."""
    if table.boards:
        raise InputError(
            f"The table holds dots of boards by name ({listed(table.boards)}), which arrays by col and row "
            "cannot keep apart. Take the lines of one: `table.where(table.board == 'NAME')`."
        )
    named = table.where(table.has_id)
    axis = DotAxis.of(named.index)
    shape = (len(named.views), len(named.cameras), len(axis))
    place = (named.view_number, named.camera_number, axis.number)
    axis.require_once(place, "picture")
    position, covariance = np.full((*shape, 2), np.nan), np.full((*shape, 2, 2), np.nan)
    flag = np.full(shape, "", dtype=named.flag.dtype if len(named) else "<U1")
    position[place], covariance[place], flag[place] = named.position, named.covariance, named.flag
    dims = ("view", "camera", "dot")
    found: xarray.Dataset = optional_module("xarray", "data").Dataset(
        {
            "position": ((*dims, "coordinate"), position, {"units": "px"}),
            "covariance": ((*dims, "coordinate", "coordinate_2"), covariance, {"units": "px2"}),
            "flag": (dims, flag),
        },
        coords={
            "view": list(named.views),
            "camera": list(named.cameras),
            "col": ("dot", axis.index[:, 0]),
            "row": ("dot", axis.index[:, 1]),
            "coordinate": ["x", "y"],
            "coordinate_2": ["x", "y"],
        },
        attrs={"dots_without_id": int((~table.has_id).sum())},
    )
    return found
