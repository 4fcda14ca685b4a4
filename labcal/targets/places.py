"""True places of the dots of one copy of a target: the file of ``labcal calibrate --free-dots``."""

from collections.abc import Callable
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Bool, Float64
from pydantic import BaseModel, ConfigDict, Field, model_serializer, model_validator

from labcal.arguments import object_of
from labcal.arrays import Vectors3
from labcal.bounds import MOST_MM, Millimetres
from labcal.geometry.covariances import valid_or_not_stated
from labcal.paths import AnyPath, as_path
from labcal.run.documents import read_document
from labcal.run.file_kinds import beginning_with
from labcal.run.outputs import write_file
from labcal.targets.catalogue import AnyTarget, DescribedTarget

_BEGINNING_BYTES = 64
KIND = beginning_with("a RIG-dots.json", b'{\n  "format": "labcal-dots"')


class DotPlace(BaseModel):
    """One dot: its place in the target's frame with its covariance, mm and mm squared."""

    model_config = ConfigDict(frozen=True, extra="forbid", allow_inf_nan=False)

    col: Annotated[int, Field(ge=0)]
    row: Annotated[int, Field(ge=0)]
    x_mm: Millimetres
    y_mm: Millimetres
    z_mm: Millimetres
    cov_xx: float
    cov_xy: float
    cov_xz: float
    cov_yy: float
    cov_yz: float
    cov_zz: float
    pictures: Annotated[int, Field(ge=0, le=1_000_000)]
    """Number of pictures in which it was measured."""
    freed: bool
    """True if the place was estimated; else it is the declared one, with a covariance of 0."""


_MOST_DIRECTIONS = 100
Direction = tuple[Millimetres, ...]
"""An error of all dots: x, y, z of each in turn, mm."""


class DotPlaces(BaseModel):
    """Every dot of a target, row by row. The mean scale is that of the declared pitch."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    format: Literal["labcal-dots"] = "labcal-dots"
    """Kind of the file."""
    format_version: Literal[1] = 1
    """Version of the form of the file."""
    target: DescribedTarget
    """The target as declared."""
    dots: tuple[DotPlace, ...]
    """Dots with their places on the print."""
    calibrated_on: tuple[str, ...] = ()
    """Names of the views that determine the places: lengths in these are no check of it."""

    shared: Annotated[tuple[Direction, ...], Field(max_length=_MOST_DIRECTIONS)] = ()
    """Errors that dots have in common, independent of each other, one standard deviation each: x, y, z of
    every dot in turn, mm. The covariances of the dots contain them."""
    datum: Annotated[tuple[Direction, ...], Field(max_length=_MOST_DIRECTIONS)] = ()
    """The same of what no picture tells, above all the mean scale: the covariances do not contain it."""

    @model_serializer(mode="wrap")
    def _without_what_is_not_there(self, dump: Callable[[BaseModel], dict[str, object]]) -> dict[str, object]:
        optional = ("calibrated_on", "shared", "datum")
        return {key: value for key, value in dump(self).items() if key not in optional or value}

    @model_validator(mode="after")
    def _every_dot_once(self) -> "DotPlaces":
        if [[dot.col, dot.row] for dot in self.dots] != self.target.indices().tolist():
            raise ValueError("the dots must be those of the target, each once, row by row")
        if not valid_or_not_stated(self.covariances(), MOST_MM**2).all():
            raise ValueError("a covariance has a negative variance, or one beyond any sense")
        if any(len(direction) != 3 * len(self.dots) for direction in (*self.shared, *self.datum)):
            raise ValueError("an error in 'shared' or 'datum' has not x, y, z of every dot")
        return self

    @classmethod
    def of(
        cls,
        target: AnyTarget,
        places: Vectors3,
        covariance: Float64[np.ndarray, "dots 3 3"],
        pictures: np.ndarray,
        freed: np.ndarray,
    ) -> "DotPlaces":
        """Return the document of places in the order of the target's indices, mm."""
        rows, cols = np.triu_indices(3)
        dots = []
        for number, (col, row) in enumerate(target.indices().tolist()):
            x, y, z = places[number].tolist()
            xx, xy, xz, yy, yz, zz = covariance[number][rows, cols].tolist()
            dots.append(
                DotPlace(
                    col=col, row=row, x_mm=x, y_mm=y, z_mm=z,
                    cov_xx=xx, cov_xy=xy, cov_xz=xz, cov_yy=yy, cov_yz=yz, cov_zz=zz,
                    pictures=int(pictures[number]), freed=bool(freed[number]),
                )
            )  # fmt: skip
        return cls(target=target, dots=tuple(dots))

    @classmethod
    def load(cls, path: AnyPath) -> "DotPlaces":
        """Read ``RIG-dots.json``; as :func:`read_places`, which lists its errors."""
        return read_places(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``RIG-dots.json``; as :func:`write_places`, which lists its errors."""
        write_places(path, self, force=force)

    def points(self) -> Vectors3:
        """Return the places in the order of the target's indices, mm, shape (dots, 3)."""
        return np.array([[dot.x_mm, dot.y_mm, dot.z_mm] for dot in self.dots])

    def covariances(self) -> Float64[np.ndarray, "dots 3 3"]:
        """Return the covariances of the places in the same order, mm squared."""
        upper = [
            [dot.cov_xx, dot.cov_xy, dot.cov_xz, dot.cov_yy, dot.cov_yz, dot.cov_zz] for dot in self.dots
        ]
        return np.array(upper, dtype=np.float64).reshape(-1, 6)[:, [[0, 1, 2], [1, 3, 4], [2, 4, 5]]]

    def independent_covariances(self) -> Float64[np.ndarray, "dots 3 3"]:
        """Return the parts of the covariances that dots do not have in common, mm squared."""
        common = np.array(self.shared).reshape(-1, len(self.dots), 3)
        left = self.covariances() - np.einsum("kia,kib->iab", common, common)
        size, axes = np.linalg.eigh(left)  # rounding may leave a variance below nothing
        return np.asarray((axes * np.maximum(size, 0.0)[:, None]) @ axes.transpose(0, 2, 1))

    def common_errors(self) -> Float64[np.ndarray, "coordinates directions"]:
        """Return the errors that all dots have in common, one standard deviation each, mm."""
        return np.array([*self.shared, *self.datum]).reshape(-1, 3 * len(self.dots)).T

    def freed(self) -> Bool[np.ndarray, " dots"]:
        """Return which places were estimated, in the order of the target's indices."""
        return np.array([dot.freed for dot in self.dots], dtype=bool)


def write_places(path: AnyPath, places: DotPlaces, *, force: bool = False) -> None:
    """Write the file.

    Raises
    ------
    OutputError
        It exists and `force` is not set, or it cannot be written.
    """
    places = object_of(places, DotPlaces, "places")
    write_file(as_path(path), places.model_dump_json(indent=2) + "\n", kind=KIND, force=force)


def is_places(path: AnyPath) -> bool:
    """Tell whether a path is that of a file of places, by its beginning."""
    place = as_path(path)
    if not place.is_file():
        return False
    with place.open("rb") as file:
        return b'"labcal-dots"' in file.read(_BEGINNING_BYTES)


def read_places(path: AnyPath) -> DotPlaces:
    """Read the file.

    Raises
    ------
    InputError
        It cannot be read, is no such file, or comes from a newer version.
    """
    return read_document(DotPlaces, "table of places of dots", as_path(path))
