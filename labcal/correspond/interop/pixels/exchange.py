"""Data that pass between named pixels and the tables of other programs."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.sources import loose_source
from labcal.errors import InputError
from labcal.run.names import is_name
from labcal.wording import clipped, printable


@dataclass(frozen=True)
class PixelOptions:
    """Facts that a user gives about tables that do not state them."""

    cameras: Mapping[str, str] = field(default_factory=dict)
    """Cameras by endings or patterns of the files' (or pictures') names."""
    columns: str | None = None
    """Columns that hold the pixels, of tables without a fixed form."""
    likelihood: float | None = None
    """Least likelihood of a pixel that is used."""


@dataclass(frozen=True)
class ReadPixels:
    """Named pixels from another program's tables."""

    pixels: NamedPixels
    notes: tuple[str, ...] = ()
    """Notes for people: assumptions, and what was left out."""


@dataclass(frozen=True)
class PixelFormat:
    """A format of tables of pixels."""

    name: str
    """As for ``--from``."""
    files: str
    """Its files, for people."""
    options: tuple[str, ...]
    """Options of ``labcal convert`` that it takes."""
    read: Callable[[Sequence[Path], PixelOptions], ReadPixels]


class PixelLines:
    """Lines of named pixels, gathered one by one."""

    def __init__(self) -> None:
        self._names: list[tuple[str, str, str]] = []
        self._figures: list[tuple[float, float, float]] = []

    def add(self, names: tuple[str, str, str], x: float, y: float, sigma: float = float("nan")) -> None:
        """Add a pixel of a view, camera and point; `sigma` is its standard deviation, px, where known."""
        self._names.append(names)
        self._figures.append((x, y, sigma))

    def table(self) -> NamedPixels:
        """Return the table of all lines."""
        names = np.array(self._names, dtype=np.str_).reshape(-1, 3)
        figures = np.array(self._figures).reshape(-1, 3)
        covariance = figures[:, 2, None, None] ** 2 * np.eye(2)
        covariance[np.isnan(figures[:, 2])] = np.nan
        return NamedPixels(names[:, 0], names[:, 1], names[:, 2], figures[:, :2], covariance)


def camera_of_file(path: Path, cameras: Mapping[str, str]) -> tuple[str, str]:
    """Return the camera of a table that is one camera's, and the rest of its name.

    Parameters
    ----------
    path : Path
    cameras : mapping of str to str
        By endings or patterns of file names; where empty, the name of the file is the camera's.

    Raises
    ------
    InputError
        The name fits no ending, or is no name of a camera.
    """
    if path.stem in cameras:
        return cameras[path.stem], ""
    if cameras:
        source = loose_source(str(path), cameras)
        return source.camera, source.view
    if not is_name(path.stem):
        raise InputError(
            f"The name of {path} is taken for a camera's, but '{clipped(printable(path.stem))}' is none. "
            "Name the cameras by the ends of file names: `cameras='_0=left,_1=right'`."
        )
    return path.stem, ""
