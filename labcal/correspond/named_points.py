"""Reconstructed points that have names, in one table, a line a point of a view."""

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from labcal.arrays import AnyArray, PointCovariances, float_array, text_array
from labcal.correspond.points import symmetric
from labcal.correspond.table_lines import PointLines
from labcal.paths import AnyPath

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, init=False, eq=False, repr=False)
class NamedPoints(PointLines):
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

    name: np.ndarray
    """(n,) of str, the name of the point."""

    def __init__(
        self, view: AnyArray, name: AnyArray, point: AnyArray, covariance: AnyArray, flag: AnyArray
    ) -> None:
        n = np.shape(np.asarray(view))[:1]
        self._keep(
            {
                "view": text_array(view, n, "view"),
                "name": text_array(name, n, "name"),
                "point": float_array(point, (*n, 3), "point"),
                "covariance": symmetric(float_array(covariance, (*n, 3, 3), "covariance")),
                "flag": text_array(flag, n, "flag"),
            }
        )

    def with_covariances(self, covariance: PointCovariances) -> "NamedPoints":
        """Return the same points with other covariances, mm squared."""
        return NamedPoints(self.view, self.name, self.point, covariance, self.flag)

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
