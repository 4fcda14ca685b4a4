"""Pixels of points that are not a target's: each has a name, by which cameras agree on it."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.arrays import AnyArray, PixelCovariances, float_array, text_array
from labcal.correspond.table_lines import PictureLines
from labcal.paths import AnyPath
from labcal.public_object import HtmlTable
from labcal.run.table_columns import numbers_of_names

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True, init=False, eq=False, repr=False)
class NamedPixels(PictureLines):
    """Named pixels in columns of equal length: a line for each point in each picture that shows it.

    The same name in two cameras of a view is the same point. Whoever finds pixels (coded markers, plain dots,
    a correlation or tracking program) hands them on in this form. Columns may be given as anything that NumPy
    takes; two tables are equal where all their lines are, in their order.

    Raises
    ------
    InputError, InputTypeError
        A column has another length or shape than its lines need, or elements of another type.

    Examples
    --------
    >>> from labcal import NamedPixels
    >>> NamedPixels(["v", "v"], ["left", "right"], ["corner", "corner"], [[401.2, 233.7], [350.9, 231.0]])
    NamedPixels(views=1, cameras=['left', 'right'], points=1, pixels=2, with_covariance=0)
    """

    point: np.ndarray
    """(n,) of str, the name of the point."""
    position: Float64[np.ndarray, "n 2"]
    """Px; NaN where not measured."""
    covariance: Float64[np.ndarray, "n 2 2"]
    """Of `position`, px squared; NaN where it is not known."""

    def __init__(
        self,
        view: AnyArray,
        camera: AnyArray,
        point: AnyArray,
        position: AnyArray,
        covariance: AnyArray | None = None,
    ) -> None:
        n = np.shape(np.asarray(view))[:1]
        unknown = np.full((*n, 2, 2), np.nan)
        self._keep(
            {
                "view": text_array(view, n, "view"),
                "camera": text_array(camera, n, "camera"),
                "point": text_array(point, n, "point"),
                "position": float_array(position, (*n, 2), "position"),
                "covariance": float_array(
                    unknown if covariance is None else covariance, (*n, 2, 2), "covariance"
                ),
            }
        )

    @cached_property
    def point_number(self) -> Int64[np.ndarray, " n"]:
        """Of each line, the place of its point among the names of points, in order of appearance."""
        return numbers_of_names(self.point.tolist(), {})

    def with_covariances(self, covariance: PixelCovariances) -> "NamedPixels":
        """Return the same pixels with other covariances, px squared."""
        made = NamedPixels(self.view, self.camera, self.point, self.position, covariance)
        return made.numbered(self.view_number, self.point_number)

    def numbered(self, view: Int64[np.ndarray, " n"], point: Int64[np.ndarray, " n"]) -> "NamedPixels":
        """Return these pixels, whose views and points are numbered already, which saves time with many.

        Parameters
        ----------
        view, point : ndarray, shape (n,)
            What :attr:`view_number` and :attr:`point_number` are.
        """
        self.__dict__.update(view_number=view, point_number=point)  # where a cached property keeps its value
        return self

    @property
    def has_covariance(self) -> Bool[np.ndarray, " n"]:
        """The lines whose covariance is known."""
        return np.asarray(~np.isnan(self.covariance).any(axis=(1, 2)))

    @classmethod
    def load(cls, path: AnyPath) -> "NamedPixels":
        """Read ``pixels.csv``; as :func:`labcal.read_pixels`, which lists its errors."""
        from labcal.correspond.named_pixels_csv import read_pixels  # noqa: PLC0415 -- it makes this class

        return read_pixels(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``pixels.csv``; as :func:`labcal.write_pixels`, which lists its errors.

        Examples
        --------
        >>> import tempfile
        >>> from labcal import NamedPixels, examples
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     examples.pixels().save(f"{folder}/pixels.csv")
        ...     NamedPixels.load(f"{folder}/pixels.csv") == examples.pixels()
        True
        """
        from labcal.correspond.named_pixels_csv import write_pixels  # noqa: PLC0415 -- as above

        write_pixels(path, self, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return the table with the columns of ``pixels.csv``.

        Raises
        ------
        DeviceError
            pandas is not installed.

        Examples
        --------
        >>> from labcal import examples
        >>> examples.pixels().to_pandas().columns[:5].tolist()
        ['view', 'camera', 'point', 'x_px', 'y_px']
        """
        from labcal.correspond.named_dataframes import pixels_frame  # noqa: PLC0415 -- pandas is optional

        return pixels_frame(self)

    def _summary(self) -> Mapping[str, object]:
        return {
            "views": len(self.views),
            "cameras": list(self.cameras),
            "points": len(dict.fromkeys(self.point.tolist())),
            "pixels": len(self),
            "with_covariance": int(self.has_covariance.sum()),
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        counts = Counter(self.camera.tolist())
        return [HtmlTable(("camera", "pixels"), [[name, str(n)] for name, n in counts.items()])]
