"""``pixels.csv``: its columns, read line by line with checks, and written."""

from collections.abc import Iterator
from itertools import islice

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arguments import object_of
from labcal.bounds import LEAST_VARIANCE_PX2, LONGEST_SIDE_PX
from labcal.correspond.named_matching import match_named
from labcal.correspond.named_pixels import NamedPixels
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import beginning_with
from labcal.run.file_reading import first_line
from labcal.run.names import is_name
from labcal.run.outputs import write_file
from labcal.run.table_columns import TableLines, names_of_lines, numbers_of_names, table_parts
from labcal.run.tables import columns_text, refuse_twice
from labcal.wording import clipped, has_control, printable

HEADER = ("view", "camera", "point", "x_px", "y_px", "var_xx", "var_xy", "var_yy")
"""With covariances; the last three columns may be left out where none is known."""
SHORT_HEADER = HEADER[:5]
KIND = beginning_with(
    "a table of pixels", f"{','.join(HEADER)}\n".encode(), f"{','.join(SHORT_HEADER)}\n".encode()
)
MOST_BYTES = 2**29
"""Of the file: a million points in two cameras, with covariances, in all their digits."""
MOST_LETTERS = 4096
"""Of a name."""
_BLOCK = 2**14


def is_pixels(path: AnyPath) -> bool:
    """Tell whether a file is a table of pixels, by its first line."""
    return first_line(as_path(path)) in {",".join(columns).encode() for columns in (HEADER, SHORT_HEADER)}


def pixels_csv(pixels: NamedPixels) -> str:
    """Return the text of ``pixels.csv``; figures are written so that they read back exactly.

    The columns of covariances are left out where none is known.
    """
    known = bool(pixels.has_covariance.any())
    return columns_text(HEADER if known else SHORT_HEADER, _parts(pixels, 5 if known else 2))


def _parts(pixels: NamedPixels, figures: int) -> Iterator[list[list[object] | np.ndarray]]:
    """Yield the columns of some lines of a table after the others, with so many figures in each."""
    for first in range(0, len(pixels), _BLOCK):
        part = slice(first, first + _BLOCK)
        upper = pixels.covariance[part].reshape(-1, 4)[:, [0, 1, 3]]
        numbers = np.column_stack([pixels.position[part], upper])[:, :figures]
        names = (pixels.view[part].tolist(), pixels.camera[part].tolist(), pixels.point[part].tolist())
        yield [*names, *numbers.T]


def read_pixels(path: AnyPath) -> NamedPixels:
    """Read ``pixels.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        The file; its last three columns, the covariances, may be left out, or empty in some lines.

    Returns
    -------
    NamedPixels

    Raises
    ------
    InputError
        It cannot be read, has other columns, a line in it is damaged, or two are of the same point in a
        picture; the line is named.

    Examples
    --------
    >>> from labcal import examples, read_pixels
    >>> examples.pixels().save("pixels.csv")
    >>> read_pixels("pixels.csv")
    NamedPixels(views=1, cameras=['left', 'right'], points=5, pixels=10, with_covariance=10)
    """
    place = as_path(path)
    begin = first_line(place)
    if begin and not all(name.encode() in begin for name in SHORT_HEADER):
        raise InputError(
            f"{place} is no table of pixels: its first line should be {','.join(SHORT_HEADER)}, and where "
            f"known {','.join(HEADER[5:])}. 'labcal convert' makes one from tables of DeepLabCut and "
            "anipose (dlc), COLMAP (colmap-tracks), DICe (dice-subsets) and any with columns that you name "
            "(columns)."
        )
    header = HEADER if b"var_xx" in begin else SHORT_HEADER
    views, cameras, points = dict[str, int](), dict[str, int](), dict[str, int]()
    read = [
        _columns(part, views, cameras, points) for part in table_parts(header, "pixels", place, MOST_BYTES)
    ]
    numbers, figures = (
        (np.concatenate(column) for column in zip(*read, strict=True))
        if read
        else (np.empty((0, 3), dtype=np.int64), np.empty((0, 5)))
    )
    refuse_twice(place, numbers, "point in a picture")
    return NamedPixels(
        names_of_lines(place, list(views), numbers[:, 0]),
        names_of_lines(place, list(cameras), numbers[:, 1]),
        names_of_lines(place, list(points), numbers[:, 2]),
        figures[:, :2],
        figures[:, [2, 3, 3, 4]].reshape(-1, 2, 2),
    ).numbered(numbers[:, 0], numbers[:, 2])


def write_pixels(path: AnyPath, pixels: NamedPixels, *, force: bool = False) -> None:
    """Write ``pixels.csv``.

    Parameters
    ----------
    path : str or os.PathLike
        The file to appear.
    pixels : NamedPixels
        What to write.
    force : bool
        Replace a table of pixels that exists.

    Raises
    ------
    InputError, InputTypeError
        These are no named pixels, or something in them could not be read again: a name, a point that is
        listed twice for a picture, a pixel that is in no picture.
    OutputError
        The file exists and `force` is not set, or it cannot be written.

    Examples
    --------
    >>> from labcal import examples, read_pixels, write_pixels
    >>> write_pixels("pixels.csv", examples.pixels())
    >>> read_pixels("pixels.csv") == examples.pixels()
    True
    """
    pixels = object_of(pixels, NamedPixels, "pixels")
    _require_readable(pixels)
    write_file(as_path(path), pixels_csv(pixels), kind=KIND, force=force)


def _require_readable(pixels: NamedPixels) -> None:
    """Raise where a table holds what :func:`read_pixels` refuses."""
    for camera in pixels.cameras:
        if not is_name(camera):
            raise _unwritable("camera", camera, "letters, digits and hyphens")
    for column, names in (("view", pixels.view), ("point", pixels.point)):
        for name in dict.fromkeys(names.tolist()):
            if not _is_readable(name):
                raise _unwritable(column, name, f"1 to {MOST_LETTERS} printable characters")
    match_named(pixels, pixels.cameras)  # which refuses a point that is listed twice
    wrong = np.flatnonzero(
        ~(_near(pixels.position) & _covaries(pixels.covariance.reshape(-1, 4)[:, [0, 1, 3]]))
    )
    if len(wrong):
        line = int(wrong[0])
        point, view = (clipped(printable(names[line])) for names in (pixels.point, pixels.view))
        raise InputError(
            f"The point '{point}' of view '{view}' cannot be written to a table: "
            f"{pixels.position[line].tolist()} px with the covariance "
            f"{pixels.covariance[line].tolist()} is no pixel."
        )


def _unwritable(column: str, name: str, expected: str) -> InputError:
    given = clipped(printable(name))
    return InputError(f"The {column} '{given}' cannot be written to a table. Give it a name of {expected}.")


def _is_readable(name: str) -> bool:
    return 1 <= len(name) <= MOST_LETTERS and not has_control(name)


def _columns(
    part: TableLines, views: dict[str, int], cameras: dict[str, int], points: dict[str, int]
) -> tuple[Int64[np.ndarray, "n 3"], Float64[np.ndarray, "n 5"]]:
    """Return numbers of view, camera and point, and figures of lines; raise at a damaged one."""
    numbers = np.column_stack(
        [
            _numbers(part, "view", views, f"a view's name has 1 to {MOST_LETTERS} printable characters"),
            _numbers(part, "camera", cameras, "a camera's name has letters, digits and hyphens only"),
            _numbers(part, "point", points, f"a point's name has 1 to {MOST_LETTERS} printable characters"),
        ]
    )
    figures = part.figures(part.header[3:], empty="nan")
    figures = np.column_stack([figures, np.full((len(part), 5 - figures.shape[1]), np.nan)])
    position, variance = figures[:, :2], figures[:, 2:]
    part.require(_near(position), f"x and y are numbers of at most {2 * LONGEST_SIDE_PX} px")
    part.require(_covaries(variance), "its covariance is none")
    part.refuse()
    return numbers, figures


def _numbers(part: TableLines, column: str, known: dict[str, int], why: str) -> Int64[np.ndarray, " n"]:
    """Return the number of every line's name; a new name that is none is a fault of its line."""
    cells = part.column(column)
    before = len(known)
    numbers = numbers_of_names(cells, known)
    new = list(islice(reversed(known), len(known) - before))
    right = is_name if column == "camera" else _is_readable
    if column != "camera" and max(map(len, new), default=1) < MOST_LETTERS and "" not in new:
        new = new if has_control("".join(new)) else []  # all at once, where names are good
    wrong = [known[name] for name in new if not right(name)]
    if wrong:
        part.require(~np.isin(numbers, wrong), why)
    return numbers


def _near(position: Float64[np.ndarray, "n 2"]) -> np.ndarray:
    """Return a mask of pixels that may be in some picture, or were not measured (NaN)."""
    near = (np.abs(position) <= 2 * LONGEST_SIDE_PX).all(axis=1)
    return np.asarray(near | np.isnan(position).all(axis=1))


def _covaries(variance: Float64[np.ndarray, "n 3"]) -> np.ndarray:
    """Return a mask of lines whose xx, xy, yy (px squared) is a covariance, or not stated at all."""
    xx, xy, yy = variance.T
    with np.errstate(invalid="ignore", over="ignore"):
        least, largest = np.minimum(xx, yy), np.maximum(xx, yy)
        stated = (least >= LEAST_VARIANCE_PX2) & (largest <= LONGEST_SIDE_PX**2) & (xy * xy < xx * yy)
    return np.asarray(stated | np.isnan(variance).all(axis=1))
