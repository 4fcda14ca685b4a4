"""Tables of columns of equal length: what those of dots, pixels and points have in common."""

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from typing import TypeVar

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.arrays import AnyArray, PointCovariances, Vectors3, kept, lines_array
from labcal.public_object import HtmlTable, PublicObject
from labcal.run.table_columns import numbers_of_names

Lines = TypeVar("Lines", bound="TableLines")
OfPictures = TypeVar("OfPictures", bound="PictureLines")
OK = "ok"
"""The flag of a line that is a measurement."""


@dataclass(frozen=True, init=False, eq=False, repr=False)
class TableLines(PublicObject):
    """Columns of equal length, a line for each dot, pixel or point of a view."""

    view: np.ndarray
    """(n,) of str"""

    def _keep(self, columns: Mapping[str, np.ndarray]) -> None:
        """Store checked columns, as copies that cannot be written to."""
        for name, column in columns.items():
            object.__setattr__(self, name, kept(column))

    def __len__(self) -> int:
        return len(self.view)

    @cached_property
    def views(self) -> tuple[str, ...]:
        """Names of the views, in order of appearance."""
        return tuple(dict.fromkeys(self.view.tolist()))

    @cached_property
    def view_number(self) -> Int64[np.ndarray, " n"]:
        """Of each line, the place of its view among :attr:`views`."""
        return numbers_of_names(self.view.tolist(), {})

    def where(self: Lines, mask: AnyArray) -> Lines:  # noqa: PYI019 -- Self is not known to beartype here
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
        return replace(self, **{field.name: getattr(self, field.name)[mask] for field in fields(self)})


@dataclass(frozen=True, init=False, eq=False, repr=False)
class PictureLines(TableLines):
    """A table of pixels that cameras measured."""

    camera: np.ndarray
    """(n,) of str"""

    @cached_property
    def cameras(self) -> tuple[str, ...]:
        """Names of the cameras, in order of appearance."""
        return tuple(dict.fromkeys(self.camera.tolist()))

    @cached_property
    def camera_number(self) -> Int64[np.ndarray, " n"]:
        """Of each line, the place of its camera among :attr:`cameras`."""
        return numbers_of_names(self.camera.tolist(), {})

    def with_cameras_in_order(self: OfPictures, order: Sequence[str]) -> OfPictures:  # noqa: PYI019 -- as above
        """Return the lines of each camera together, in an order, where they do not appear in it already.

        Parameters
        ----------
        order : sequence of str
            Names of cameras. Those that are not among them come last.
        """
        wanted = [name for name in order if name in self.cameras]
        wanted += [name for name in self.cameras if name not in wanted]
        if tuple(wanted) == self.cameras:
            return self
        place = np.array([wanted.index(name) for name in self.cameras], dtype=np.int64)[self.camera_number]
        return self.where(np.argsort(place, kind="stable"))

    def by_view(self: OfPictures) -> list[OfPictures]:  # noqa: PYI019 -- as above
        """Return the lines of every view, in the order of :attr:`views`."""
        order = np.argsort(self.view_number, kind="stable")
        edges = np.searchsorted(self.view_number[order], np.arange(1, len(self.views)))
        return [self.where(lines) for lines in np.split(order, edges)]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class PointLines(TableLines):
    """A table of points in space."""

    point: Vectors3
    """(n, 3), mm; NaN where there is none."""
    covariance: PointCovariances
    """(n, 3, 3), mm squared; NaN where none is stated. Of what is given, upper triangles count."""
    flag: np.ndarray
    """(n,) of str, a :class:`~labcal.correspond.points.PointFlag`."""

    @property
    def ok(self) -> Bool[np.ndarray, " n"]:
        """The points that are flagged ``ok``."""
        return np.asarray(self.flag == OK)

    @property
    def sigma_mm(self) -> Float64[np.ndarray, " n"]:
        """Standard deviation of each point, mm: root of its covariance's trace; NaN where none is stated."""
        return np.asarray(np.sqrt(np.trace(self.covariance, axis1=1, axis2=2)))

    def _summary(self) -> Mapping[str, object]:
        stated = self.sigma_mm[np.isfinite(self.sigma_mm)]
        summary: dict[str, object] = {
            "views": len(self.views),
            "points": len(self),
            "ok": int(self.ok.sum()),
        }
        if len(stated):
            summary["median_sigma"] = f"{np.median(stated):.3g} mm"
        return summary

    def _html_tables(self) -> Sequence[HtmlTable]:
        return [HtmlTable(("flag", "points"), [[k, str(n)] for k, n in Counter(self.flag.tolist()).items()])]
