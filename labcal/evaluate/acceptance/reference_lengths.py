"""Known lengths between points: the reference of an acceptance test, and its table ``lengths.csv``."""

from dataclasses import dataclass
from math import isfinite

import numpy as np

from labcal.arguments import object_of
from labcal.arrays import AnyArray, Lengths, float_array, kept, text_array
from labcal.bounds import LEAST_MM, MOST_MM
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.public_object import PublicObject
from labcal.run.file_kinds import beginning_with
from labcal.run.file_reading import first_line
from labcal.run.outputs import write_file
from labcal.run.table_columns import TableLines, table_parts
from labcal.run.tables import table_text
from labcal.wording import clipped, has_control, printable

HEADER = ("line", "length", "view_a", "point_a", "view_b", "point_b", "nominal_mm", "sigma_mm")
"""The last column may be left out where the lengths count as exact."""
KIND = beginning_with("a table of lengths", f"{','.join(HEADER)}\n".encode())
_MOST_LENGTHS = 10_000
_NAMES = HEADER[:6]


@dataclass(frozen=True, init=False, eq=False, repr=False)
class ReferenceLengths(PublicObject):
    """Known lengths between two points each, on measuring lines.

    Columns may be given as anything that NumPy takes.

    Parameters
    ----------
    line, length : array_like of str, shape (n,)
        Name of the measuring line, and of the length on it.
    view_a, point_a, view_b, point_b : array_like of str, shape (n,)
        The ends, by view and name; a dot of a target is named ``col:row``.
    nominal_mm : array_like, shape (n,)
        Calibrated length, mm.
    sigma_mm : array_like, shape (n,), optional
        Standard uncertainty of the calibrated length, mm; 0 where it counts as exact.

    Raises
    ------
    InputError, InputTypeError
        A column has another length, a length is not positive, an end has no name, both are one point, or a
        length is listed twice.

    Examples
    --------
    >>> from labcal import examples
    >>> examples.lengths()
    ReferenceLengths(lines=1, lengths=3, shortest=70.7 mm, longest=100 mm)
    """

    line: np.ndarray
    length: np.ndarray
    view_a: np.ndarray
    point_a: np.ndarray
    view_b: np.ndarray
    point_b: np.ndarray
    nominal_mm: Lengths
    sigma_mm: Lengths

    def __init__(  # noqa: PLR0913, PLR0917 -- as many as columns
        self,
        line: AnyArray,
        length: AnyArray,
        view_a: AnyArray,
        point_a: AnyArray,
        view_b: AnyArray,
        point_b: AnyArray,
        nominal_mm: AnyArray,
        sigma_mm: AnyArray | None = None,
    ) -> None:
        n = np.shape(np.asarray(line))[:1]
        for name, column in zip(_NAMES, (line, length, view_a, point_a, view_b, point_b), strict=True):
            object.__setattr__(self, name, kept(text_array(column, n, name)))
        sigma = np.zeros(n) if sigma_mm is None else sigma_mm
        for name, column in (("nominal_mm", nominal_mm), ("sigma_mm", sigma)):
            object.__setattr__(self, name, kept(float_array(column, n, name)))
        known = set[tuple[str, str]]()
        for number in range(len(self)):
            wrong = _fault(self, number)
            key = (str(self.line[number]), str(self.length[number]))
            if wrong is None and key in known:
                wrong = "it is listed twice"
            if wrong is not None:
                name = clipped(printable(f"{key[1]} of line {key[0]}"))
                raise InputError(f"The length '{name}' is none: {wrong}.")
            known.add(key)

    def __len__(self) -> int:
        return len(self.line)

    @classmethod
    def load(cls, path: AnyPath) -> "ReferenceLengths":
        """Read ``lengths.csv``; as :func:`read_lengths`, which lists its errors."""
        return read_lengths(path)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write ``lengths.csv``.

        Parameters
        ----------
        path : str or os.PathLike
        force : bool
            Replace a table of lengths that exists.

        Raises
        ------
        OutputError
            The file exists and `force` is not set, or it cannot be written.

        Examples
        --------
        >>> from labcal import ReferenceLengths, examples
        >>> examples.lengths().save("lengths.csv")
        >>> ReferenceLengths.load("lengths.csv") == examples.lengths()
        True
        """
        write_file(as_path(path), lengths_csv(self), kind=KIND, force=force)

    def _summary(self) -> dict[str, object]:
        summary: dict[str, object] = {"lines": len(set(self.line.tolist())), "lengths": len(self)}
        if len(self):
            ends = {"shortest": self.nominal_mm.min(), "longest": self.nominal_mm.max()}
            summary |= {name: f"{value:.3g} mm" for name, value in ends.items()}
        return summary


def _fault(lengths: ReferenceLengths, number: int) -> str | None:
    """Return why a line is no length; None where it is one."""
    for name in _NAMES:
        text = str(getattr(lengths, name)[number])
        if not text or has_control(text):
            return f"its {name} is no name"
    if (lengths.view_a[number], lengths.point_a[number]) == (lengths.view_b[number], lengths.point_b[number]):
        return "both ends are the same point"
    nominal, sigma = float(lengths.nominal_mm[number]), float(lengths.sigma_mm[number])
    if not (isfinite(nominal) and LEAST_MM <= nominal <= MOST_MM):
        return "nominal_mm is not a positive number of mm"
    if not (isfinite(sigma) and 0.0 <= sigma <= nominal):
        return "sigma_mm is no standard uncertainty of such a length, mm"
    return None


def lengths_csv(lengths: ReferenceLengths) -> str:
    """Return the text of ``lengths.csv``."""
    lengths = object_of(lengths, ReferenceLengths, "lengths")
    columns = [getattr(lengths, name).tolist() for name in HEADER]
    return table_text(HEADER, (list(line) for line in zip(*columns, strict=True)))


def read_lengths(path: AnyPath) -> ReferenceLengths:
    """Read ``lengths.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        Its last column may be left out, or be empty in some lines: these lengths count as exact.

    Raises
    ------
    InputError
        It cannot be read, has other columns, or a line in it is damaged; the line is named.

    Examples
    --------
    >>> from labcal import ReferenceLengths, examples
    >>> examples.lengths().save("lengths.csv")
    >>> ReferenceLengths.load("lengths.csv")
    ReferenceLengths(lines=1, lengths=3, shortest=70.7 mm, longest=100 mm)
    """
    place = as_path(path)
    header = HEADER if b"sigma_mm" in first_line(place) else HEADER[:-1]
    names: dict[str, list[str]] = {name: [] for name in _NAMES}
    figures = [np.empty((0, 2))]
    for part in table_parts(header, "lengths", place):
        figures.append(_figures(part))
        for name in _NAMES:
            names[name] += part.column(name)
    every = np.concatenate(figures)
    if not 1 <= len(every) <= _MOST_LENGTHS:
        raise InputError(f"{place} lists {len(every)} lengths; 1 to {_MOST_LENGTHS} are possible.")
    try:
        return ReferenceLengths(
            names["line"], names["length"], names["view_a"], names["point_a"], names["view_b"],
            names["point_b"], every[:, 0], every[:, 1],
        )  # fmt: skip
    except InputError as error:
        raise InputError(f"{place}: {error}") from error


def _figures(part: TableLines) -> np.ndarray:
    """Return lengths and standard uncertainties of lines; raise at a damaged one."""
    nominal = part.figures(("nominal_mm",))
    sigma = part.figures(("sigma_mm",), empty="0") if "sigma_mm" in part.header else np.zeros_like(nominal)
    part.refuse()
    return np.column_stack([nominal, sigma])
