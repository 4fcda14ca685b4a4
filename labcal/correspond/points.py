"""Reconstructed points in one table, a line a dot."""

from dataclasses import dataclass
from enum import StrEnum
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Int64

from labcal.arrays import (
    AnyArray,
    PointCovariances,
    float_array,
    text_array,
    whole_array,
)
from labcal.correspond.table_lines import PointLines
from labcal.paths import AnyPath

if TYPE_CHECKING:
    import matplotlib.figure
    import pandas
    import xarray


class PointFlag(StrEnum):
    """Flag of a reconstructed point."""

    OK = "ok"
    """Reconstructed."""
    EXTRAPOLATED = "extrapolated"
    """Outside the volume that the method was trained in."""
    MODEL_MISFIT = "model-misfit"
    """The method is known to err by far more than the noise leaves, or by more than its covariances say."""
    NO_SOLUTION = "no-solution"
    """The pixels determine no point."""
    TOO_FEW_CAMERAS = "too-few-cameras"
    """Of a named point: fewer cameras measured it than a place takes, two of a rig or all of a method."""
    OUTSIDE_PICTURE = "outside-picture"
    """Of a named point: a pixel of it lies outside of its picture and was not used."""
    AMBIGUOUS = "ambiguous"
    """Of a plain dot: several dots of another camera could be the same one, so that it has no place."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class Points(PointLines):
    """Points in columns of equal length, in the frame of the model.

    Columns may be given as anything that NumPy takes. Two tables are equal where all their lines are, in
    their order.

    Raises
    ------
    InputError, InputTypeError
        A column has another length or shape than its lines need, or elements of another type.

    Examples
    --------
    >>> from labcal import examples
    >>> examples.points()
    Points(views=8, points=704, ok=704, median_sigma=0.076 mm)
    """

    index: Int64[np.ndarray, "n 2"]
    """(col, row)"""
    board: np.ndarray
    """(n,) of str, the board that `index` is of where a view shows several; empty where it shows one."""

    def __init__(
        self,
        view: AnyArray,
        index: AnyArray,
        point: AnyArray,
        covariance: AnyArray,
        flag: AnyArray,
        board: AnyArray | None = None,
    ) -> None:
        n = np.shape(np.asarray(view))[:1]
        board = np.full(n, "") if board is None else board
        self._keep(
            {
                "view": text_array(view, n, "view"),
                "index": whole_array(index, (*n, 2), "index"),
                "point": float_array(point, (*n, 3), "point"),
                "covariance": symmetric(float_array(covariance, (*n, 3, 3), "covariance")),
                "flag": text_array(flag, n, "flag"),
                "board": text_array(board, n, "board"),
            }
        )

    @cached_property
    def boards(self) -> tuple[str, ...]:
        """Names of the boards, in order of appearance; nothing where views show one target."""
        return tuple(name for name in dict.fromkeys(self.board.tolist()) if name)

    @classmethod
    def load(cls, path: AnyPath) -> "Points":
        """Read ``points.csv``; as :func:`labcal.read_points`, which lists its errors."""
        from labcal.correspond.points_csv import read_points  # noqa: PLC0415 -- it makes this class

        return read_points(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``points.csv``; as :func:`labcal.write_points`, which lists its errors.

        Examples
        --------
        >>> import tempfile
        >>> from labcal import Points, examples
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     examples.points().save(f"{folder}/points.csv")
        ...     Points.load(f"{folder}/points.csv") == examples.points()
        True
        """
        from labcal.correspond.points_csv import write_points  # noqa: PLC0415 -- as above

        write_points(path, self, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table with the columns of ``points.csv``.

        Raises
        ------
        DeviceError
            pandas is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> examples.points().to_pandas().columns[:6].tolist()
        ['view', 'col', 'row', 'X_mm', 'Y_mm', 'Z_mm']
        """
        from labcal.correspond.point_dataframes import points_frame  # noqa: PLC0415 -- pandas is optional

        return points_frame(self)

    def to_xarray(self) -> "xarray.Dataset":
        """Return points and covariances as arrays of dimensions view, dot and coordinate.

        Elements without a line of the table are NaN, with an empty flag.

        Raises
        ------
        InputError
            A dot is listed twice for a view.
        DeviceError
            xarray is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> dict(examples.points().to_xarray()["point"].sizes)
        {'view': 8, 'dot': 88, 'coordinate': 3}
        """
        from labcal.correspond.point_dataframes import points_dataset  # noqa: PLC0415 -- xarray is optional

        return points_dataset(self)

    def plot(self) -> "matplotlib.figure.Figure":
        """Draw the points in space, coloured by their standard deviations, mm.

        Points whose method states no covariance are grey. A solution that is missing is not drawn; the title
        says how many are.

        Examples
        --------
        >>> from labcal import examples
        >>> examples.points().plot().axes[0].get_xlabel()
        'X (mm)'
        """
        from labcal.correspond.points_figure import points_figure  # noqa: PLC0415 -- imports matplotlib

        return points_figure(self)


def symmetric(covariance: PointCovariances) -> PointCovariances:
    """Return matrices with the upper triangles of these: the file holds no more, and both must agree."""
    lower = np.swapaxes(covariance, -1, -2)
    if np.array_equal(covariance, lower, equal_nan=True):
        return covariance
    return np.where(np.tri(covariance.shape[-1], k=-1, dtype=bool), lower, covariance)
