"""Points as a table of pandas, and as arrays of xarray."""

from typing import TYPE_CHECKING

import numpy as np

from labcal.correspond.dot_axis import DotAxis
from labcal.correspond.points import Points
from labcal.correspond.points_csv import BOARD, HEADER, UPPER
from labcal.errors import InputError
from labcal.extras import optional_module
from labcal.wording import listed

if TYPE_CHECKING:
    import pandas
    import xarray


def points_frame(points: Points) -> "pandas.DataFrame":
    """Return the columns of ``points.csv``; see :meth:`Points.to_pandas`."""
    upper = points.covariance[:, UPPER[0], UPPER[1]]
    columns = (points.view, *points.index.T, *points.point.T, *upper.T, points.flag)
    board = {BOARD: points.board} if points.boards else {}
    frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
        {**dict(zip(HEADER, columns, strict=True)), **board}
    )
    return frame


def points_dataset(points: Points) -> "xarray.Dataset":
    """Return named arrays; see :meth:`Points.to_xarray`."""
    if points.boards:
        raise InputError(
            f"The table holds points of boards by name ({listed(points.boards)}), which arrays by col and "
            "row cannot keep apart. Take the lines of one: `points.where(points.board == 'NAME')`."
        )
    views = list(dict.fromkeys(points.view.tolist()))
    number = {view: at for at, view in enumerate(views)}
    axis = DotAxis.of(points.index)
    place = (np.array([number[view] for view in points.view.tolist()], dtype=np.int64), axis.number)
    axis.require_once(place, "view")
    shape = (len(views), len(axis))
    point, covariance = np.full((*shape, 3), np.nan), np.full((*shape, 3, 3), np.nan)
    flag = np.full(shape, "", dtype=points.flag.dtype if len(points) else "<U1")
    point[place], covariance[place], flag[place] = points.point, points.covariance, points.flag
    dims = ("view", "dot")
    found: xarray.Dataset = optional_module("xarray", "data").Dataset(
        {
            "point": ((*dims, "coordinate"), point, {"units": "mm"}),
            "covariance": ((*dims, "coordinate", "coordinate_2"), covariance, {"units": "mm2"}),
            "flag": (dims, flag),
        },
        coords={
            "view": views,
            "col": ("dot", axis.index[:, 0]),
            "row": ("dot", axis.index[:, 1]),
            "coordinate": ["X", "Y", "Z"],
            "coordinate_2": ["X", "Y", "Z"],
        },
    )
    return found
