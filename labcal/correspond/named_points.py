"""Reconstructed points that have names, in one table, a line a point of a view."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64

from labcal.arrays import (
    AnyArray,
    PointCovariances,
    Vectors3,
    float_array,
    kept,
    lines_array,
    text_array,
)
from labcal.correspond.points import PointFlag, symmetric
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable, PublicObject

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, init=False, eq=False, repr=False)
class NamedPoints(PublicObject):
    """Named points in columns of equal length, in the frame of the model or in one that was asked for.

    Columns may be given as anything that NumPy takes. Two tables are equal where all their lines are, in
    their order.

    Raises
    ------
    InputError, InputTypeError
        A column has another length or shape than its lines need, or elements of another type.

    Examples
    --------
    >>> from labcal import examples, pipeline
    >>> pipeline.measure(examples.rig(), examples.pixels()).points
    NamedPoints(views=1, points=5, ok=5, median_sigma=0.0719 mm)
    """

    view: np.ndarray
    """(n,) of str"""
    name: np.ndarray
    """(n,) of str, the name of the point."""
    point: Vectors3
    """(n, 3), mm; NaN where there is none."""
    covariance: PointCovariances
    """(n, 3, 3), mm squared; NaN where none is stated. Of what is given, upper triangles count."""
    flag: np.ndarray
    """(n,) of str, a :class:`~labcal.correspond.points.PointFlag`."""

    def __init__(
        self, view: AnyArray, name: AnyArray, point: AnyArray, covariance: AnyArray, flag: AnyArray
    ) -> None:
        n = np.shape(np.asarray(view))[:1]
        columns = {
            "view": text_array(view, n, "view"),
            "name": text_array(name, n, "name"),
            "point": float_array(point, (*n, 3), "point"),
            "covariance": symmetric(float_array(covariance, (*n, 3, 3), "covariance")),
            "flag": text_array(flag, n, "flag"),
        }
        for column, values in columns.items():
            object.__setattr__(self, column, kept(values))

    def __len__(self) -> int:
        return len(self.view)

    @property
    def ok(self) -> Bool[np.ndarray, " n"]:
        """The points that are flagged ``ok``."""
        return np.asarray(self.flag == PointFlag.OK.value)

    @property
    def sigma_mm(self) -> Float64[np.ndarray, " n"]:
        """Standard deviation of each point, mm: root of its covariance's trace; NaN where none is stated."""
        return np.asarray(np.sqrt(np.trace(self.covariance, axis1=1, axis2=2)))

    def where(self, mask: AnyArray) -> "NamedPoints":
        """Return the lines where the mask holds, or those of some numbers.

        Parameters
        ----------
        mask : array_like of bool, shape (n,), or of int
            A truth value for each line, or the numbers of those that are wanted, in that order.

        Raises
        ------
        InputError, InputTypeError
            It has another length, or is made of something else.
        """
        mask = lines_array(mask, len(self), "mask")
        return NamedPoints(
            self.view[mask], self.name[mask], self.point[mask], self.covariance[mask], self.flag[mask]
        )

    @classmethod
    def load(cls, path: AnyPath) -> "NamedPoints":
        """Read a table of named points; as :func:`labcal.read_named_points`, which lists its errors."""
        from labcal.correspond.named_points_csv import read_named_points  # noqa: PLC0415 -- it makes this class

        return read_named_points(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``points.csv`` with ``point`` in place of ``col, row``.

        Parameters
        ----------
        path : str or os.PathLike
            The file to appear.
        force : bool
            Replace a table of named points that exists.

        Raises
        ------
        InputError
            A name or flag could not be read again.
        OutputError
            The file exists and `force` is not set, or it cannot be written.

        Examples
        --------
        >>> import tempfile
        >>> from labcal import NamedPoints, examples, pipeline
        >>> points = pipeline.measure(examples.rig(), examples.pixels()).points
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     points.save(f"{folder}/points.csv")
        ...     NamedPoints.load(f"{folder}/points.csv") == points
        True
        """
        from labcal.correspond.named_points_csv import write_named_points  # noqa: PLC0415 -- as above

        write_named_points(path, self, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table with the columns of ``points.csv``.

        Raises
        ------
        DeviceError
            pandas is not installed.

        Examples
        --------
        >>> from labcal import examples, pipeline
        >>> points = pipeline.measure(examples.rig(), examples.pixels()).points
        >>> points.to_pandas()["point"].tolist()
        ['origin', 'right-corner', 'upper-corner', 'far-corner', 'tip']
        """
        from labcal.correspond.named_dataframes import named_points_frame  # noqa: PLC0415 -- pandas is optional

        return named_points_frame(self)

    def _summary(self) -> Mapping[str, object]:
        stated = self.sigma_mm[np.isfinite(self.sigma_mm)]
        summary: dict[str, object] = {
            "views": len(dict.fromkeys(self.view.tolist())),
            "points": len(self),
            "ok": int(self.ok.sum()),
        }
        if len(stated):
            summary["median_sigma"] = f"{np.median(stated):.3g} mm"
        return summary

    def _html_tables(self) -> Sequence[HtmlTable]:
        return [HtmlTable(("flag", "points"), [[k, str(n)] for k, n in Counter(self.flag.tolist()).items()])]
