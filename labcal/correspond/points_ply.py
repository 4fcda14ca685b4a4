"""PLY files of points, coloured by their standard deviations, for programs that show point clouds.

The format is that of Greg Turk, "The PLY Polygon File Format" (1994): a header in ASCII that names the
properties of each vertex, then the vertices as text or as little-endian bytes.
"""

from enum import StrEnum

import numpy as np
from jaxtyping import Float64, UInt8

from labcal.arguments import choice_of, wrong_type
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag, Points
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import FileKind
from labcal.run.file_marks import PLY_COMMENT
from labcal.run.outputs import write_file
from labcal.wording import counted

KIND = FileKind("a PLY file", lambda content: content.startswith(b"ply\n"), PLY_COMMENT)
_PROPERTIES = np.dtype(
    [
        ("x", "<f8"), ("y", "<f8"), ("z", "<f8"),
        ("red", "u1"), ("green", "u1"), ("blue", "u1"),
        ("sigma_x", "<f4"), ("sigma_y", "<f4"), ("sigma_z", "<f4"), ("sigma", "<f4"),
        ("ok", "u1"), ("row", "<i4"),
    ]
)  # fmt: skip
_PLY_TYPES = {"<f8": "double", "<f4": "float", "|u1": "uchar", "<i4": "int"}
_COLOURS = np.array(
    [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]], dtype=np.float64
)
"""Viridis at equal steps: dark where a point is known best."""
_NOT_OK, _UNKNOWN = (220, 30, 30), (128, 128, 128)
_QUANTILES = (0.02, 0.98)


class PlyEncoding(StrEnum):
    """Forms of the vertices in a PLY file."""

    BINARY = "binary"
    """Little-endian bytes."""
    ASCII = "ascii"
    """Text."""


def write_ply(
    path: AnyPath,
    points: Points | NamedPoints,
    encoding: PlyEncoding | str = PlyEncoding.BINARY,
    *,
    force: bool = False,
) -> None:
    """Write points as a PLY file, coloured by their standard deviations.

    Parameters
    ----------
    path : str or os.PathLike
        The file to appear, ``.ply``.
    points : Points or NamedPoints
        Those without a place are left out.
    encoding : {"binary", "ascii"}
    force : bool
        Replace a PLY file of labcal's that exists.

    Raises
    ------
    InputError, InputTypeError
        These are no points, none of them has a place, or there is no such encoding.
    OutputError
        The file exists and `force` is not set, or it cannot be written.

    Notes
    -----
    Properties of a vertex: x, y, z (mm); red, green, blue (viridis over the 2nd to the 98th percentile of
    sigma, which the header's comments state; red where the flag is not ``ok``, grey where no covariance is
    known); sigma_x, sigma_y, sigma_z (mm); sigma, the root of the covariance's trace (mm); ok (1 or 0); row,
    the number of the point's line in the table, from 0.

    Examples
    --------
    >>> from labcal import examples, write_ply
    >>> write_ply("points.ply", examples.points())
    """
    if not isinstance(points, Points | NamedPoints):
        raise wrong_type(points, "points", "points")
    form = choice_of(encoding, PlyEncoding, "encoding")
    write_file(as_path(path), ply_bytes(points, form), kind=KIND, force=force)


def ply_bytes(points: Points | NamedPoints, encoding: PlyEncoding) -> bytes:
    """Return the content of a PLY file.

    Raises
    ------
    InputError
        No point has a place.
    """
    rows = np.flatnonzero(np.isfinite(points.point).all(axis=1))
    if not len(rows):
        raise InputError(
            "None of the points has a place, so that a PLY file would be empty. See their flags."
        )
    sigma = points.sigma_mm[rows]
    ok = points.flag[rows] == PointFlag.OK.value
    known = ok & np.isfinite(sigma)
    least, most = np.quantile(sigma[known], _QUANTILES) if known.any() else (np.nan, np.nan)
    vertices = np.empty(len(rows), dtype=_PROPERTIES)
    for name, column in zip("xyz", points.point[rows].T, strict=True):
        vertices[name] = column
    spread = np.sqrt(np.diagonal(points.covariance[rows], axis1=1, axis2=2))
    for name, column in zip(("sigma_x", "sigma_y", "sigma_z"), spread.T, strict=True):
        vertices[name] = column
    vertices["sigma"], vertices["ok"], vertices["row"] = sigma, ok, rows
    colours = _colours(sigma, float(least), float(most))
    colours[~ok] = _NOT_OK
    for name, channel in zip(("red", "green", "blue"), colours.T, strict=True):
        vertices[name] = channel
    scale = f"sigma from {least:.4g} mm (dark) to {most:.4g} mm (light)" if known.any() else "sigma not known"
    left_out = counted(len(points) - len(rows), "point")
    header = _header(
        len(rows), encoding, [f"mm; colours: {scale}; red: not ok", f"{left_out} without a place"]
    )
    return header + (vertices.tobytes() if encoding is PlyEncoding.BINARY else _text(vertices))


def _header(vertices: int, encoding: PlyEncoding, comments: list[str]) -> bytes:
    form = "binary_little_endian" if encoding is PlyEncoding.BINARY else "ascii"
    properties = [f"property {_PLY_TYPES[_PROPERTIES[name].str]} {name}" for name in _PROPERTIES.names or ()]
    lines = [
        "ply", f"format {form} 1.0", *(f"comment {one}" for one in comments), f"element vertex {vertices}",
        *properties, "end_header",
    ]  # fmt: skip
    return ("\n".join(lines) + "\n").encode("ascii")


def _text(vertices: np.ndarray) -> bytes:
    """Return vertices as lines of text; figures are written so that they read back exactly."""
    columns = [[str(value) for value in vertices[name]] for name in _PROPERTIES.names or ()]
    return "".join(f"{' '.join(line)}\n" for line in zip(*columns, strict=True)).encode("ascii")


def _colours(sigma: Float64[np.ndarray, " n"], least: float, most: float) -> UInt8[np.ndarray, "n 3"]:
    """Return colours of standard deviations, mm, on the scale between two of them; grey where not known."""
    known = np.isfinite(sigma) & np.isfinite(least)
    share = np.clip((sigma - least) / max(most - least, np.finfo(float).tiny), 0.0, 1.0)
    steps = np.linspace(0.0, 1.0, len(_COLOURS))
    channels = [np.interp(np.where(known, share, 0.0), steps, channel) for channel in _COLOURS.T]
    colours = np.where(known[:, None], np.stack(channels, axis=1), _UNKNOWN)
    return np.asarray(np.rint(colours).astype(np.uint8))
