"""mrcal's and mrgingham's ``corners.vnl``: ``# filename x y weight``, a line for every point of a whole grid.

The points of an image stand together as mrgingham lists them: row by row from the top left of the board seen
upright, so that the first row in the file is labcal's last one, whose rows count upwards. ``-`` stands where
a point is missing, and a single line of ``-`` where an image has none. mrgingham numbers nothing: of a board
that is held upside down it lists the other end first. mrcal multiplies a point's error by its weight
(``--corners-cache-has-weights``). Here that is the median standard deviation of all points over the point's
own, so that the typical weight is 1 and mrcal's errors stay in pixels; a comment keeps the median. In files
of mrgingham the column is ``level``: how often the picture was halved to find the point. Its weight is 2 to
the power of minus that, as mrcal takes it.
"""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float64

from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.correspond.interop.corners_lines import points_by_image, positive_sigma, whole_grid
from labcal.correspond.matching import require_on_target
from labcal.correspond.sense import covaries_soundly, in_picture
from labcal.correspond.sources import Source, loose_source, refuse_unnamed_cameras
from labcal.detect.flags import DotFlag
from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_kinds import FileKind
from labcal.run.file_marks import VNL_COMMENT
from labcal.run.file_reading import MOST_OF_A_TABLE, read_text
from labcal.targets.catalogue import AnyTarget
from labcal.targets.target import Target

_SIGMA = re.compile(r"^## sigma_px (\S+)", re.MULTILINE)
_LEGEND = re.compile(r"^#\s*filename\s+x\s+y(?:\s+(level|weight))?\s*$", re.MULTILINE)
KIND = FileKind(
    "a corners.vnl", lambda content: _LEGEND.search(content.decode("latin-1")) is not None, VNL_COMMENT
)
_EQUAL_PITCH = 1e-9
"""Relative difference of pitches that are the same but for rounding."""
_TOP_FIRST = "## rows run from the top of the board"
"""In labcal's files. One with ``sigma_px`` but without this is older: its first row is row 0."""


@dataclass(frozen=True)
class CornersText:
    """The text of a ``corners.vnl``."""

    text: str
    points: int
    """Number of measured points."""
    left_out: int
    """Lines that stand as missing: no measurements of the grid, or at negative pixels."""


@dataclass(frozen=True)
class ReadCorners:
    """The content of a ``corners.vnl``."""

    detections: Detections
    notes: tuple[str, ...] = ()
    """Notes on assumptions that were made."""


def corners_text(detections: Detections, target: AnyTarget) -> CornersText:
    """Return detections as a ``corners.vnl``, in the order of the images.

    Parameters
    ----------
    detections : Detections
        Dots flagged ``ok`` are written; the rest of the grid is missing.
    target : AnyTarget
        Its whole grid is written.

    Raises
    ------
    InputError
        The target is no square grid, a dot is beyond it, or an image's name cannot stand in such a file.
    """
    _require_rows_and_columns(target)
    _require_square(target)
    detections = on_target(detections, target)
    # mrcal takes a negative pixel for a missing point, so such a line would be lost in silence.
    usable = detections.where(detections.ok & (detections.position >= 0.0).all(axis=1))
    require_on_target(usable, target)
    sigma = np.sqrt(0.5 * np.trace(usable.covariance, axis1=1, axis2=2))
    known = sigma[np.isfinite(sigma) & (sigma > 0.0)]
    typical = float(np.median(known)) if len(known) else 1.0
    weight = np.where(np.isfinite(sigma) & (sigma > 0.0), typical / np.where(sigma > 0.0, sigma, 1.0), 1.0)
    number = (target.rows - 1 - usable.index[:, 1]) * target.cols + usable.index[:, 0]
    lines = [f"## sigma_px {typical!r} stands for a weight of 1", _TOP_FIRST, "# filename x y weight"]
    for image in dict.fromkeys(detections.image.tolist()):
        _require_plain(image)
        rows = np.flatnonzero(usable.image == image)
        if len(rows) == 0:
            lines.append(f"{image} - - -")
            continue
        entries = [f"{image} - - -"] * target.count
        for row in rows:
            x, y = usable.position[row].tolist()
            entries[number[row]] = f"{image} {x!r} {y!r} {float(weight[row])!r}"
        lines += entries
    return CornersText("\n".join(lines) + "\n", len(usable), len(detections) - len(usable))


def read_corners(
    path: AnyPath, target: Target, endings: Mapping[str, str], size_of: Callable[[Path], tuple[int, int]]
) -> ReadCorners:
    """Read a ``corners.vnl``.

    Parameters
    ----------
    path : str or os.PathLike
    target : Target
        How many points are in a row, and how many rows there are.
    endings : mapping of str to str
        Camera by ending of an image's name, as for loose pictures; one camera where empty.
    size_of : callable
        Takes an image's path, returns width and height of the picture, px.

    Returns
    -------
    ReadCorners
        Dots row by row from (0, 0). Covariances are those of the weights times the standard deviation that a
        file of labcal states, else 1 px. A missing point has the flag ``hidden``.

    Raises
    ------
    InputError
        The file cannot be read, is damaged, an image has another number of points than the target, a point
        lies outside of its picture, two images are the same view of the same camera, or the target is no grid
        of rows and columns.
    """
    path = as_path(path)
    _require_rows_and_columns(target)
    text = read_text(path, "corners", MOST_OF_A_TABLE)
    legend = _LEGEND.search(text)
    if legend is None:
        raise InputError(
            f"{path} is no corners.vnl: it should have the line '# filename x y weight' (or level)."
        )
    stated = _SIGMA.search(text)
    sigma = positive_sigma(stated[1], path) if stated else 1.0
    images = points_by_image(text, legend[1], target, path)
    notes: tuple[str, ...] = ()
    parts = [whole_grid(image, np.array(points), target, path) for image, points in images.items()]
    if stated and _TOP_FIRST not in text:
        note = (
            f"{path} was written by an older labcal, with rows from the bottom of the board, and is read so. "
            "For other programs write it anew from detections.csv."
        )
        notes = (note,)
    else:
        parts = [_turned_over(part, target) for part in parts]
    refuse_unnamed_cameras(list(images), endings)
    sources = _sources(list(images), endings, path)
    n = target.count
    xyw = np.concatenate(parts)
    seen = xyw[:, 2] > 0.0
    variance = np.where(seen, (sigma / np.where(seen, xyw[:, 2], 1.0)) ** 2, np.nan)
    sizes = [size_of(Path(image)) for image in images]
    found = Detections(
        view=np.repeat(np.array([source.view for source in sources], dtype=np.str_), n),
        camera=np.repeat(np.array([source.camera for source in sources], dtype=np.str_), n),
        image=np.repeat(np.array(list(images), dtype=np.str_), n),
        size=np.repeat(np.array(sizes, dtype=np.int64), n, axis=0),
        index=np.tile(target.indices().astype(np.int64), (len(images), 1)),
        has_id=np.ones(len(xyw), dtype=bool),
        position=np.where(seen[:, None], xyw[:, :2], np.nan),
        covariance=variance[:, None, None] * np.eye(2),
        flag=np.where(seen, DotFlag.OK.value, DotFlag.HIDDEN.value),
    )
    sound = covaries_soundly(found.size, found.covariance.reshape(-1, 4)[:, [0, 1, 3]])
    for fits, why in (
        (in_picture(found.size, found.position), "lies outside of"),
        (sound, "is too uncertain for"),
    ):
        if (seen & ~fits).any():
            raise InputError(_words_on(found, int(np.argmax(seen & ~fits)), why, path))
    return ReadCorners(found, notes)


def _words_on(found: Detections, row: int, why: str, path: Path) -> str:
    """Return a message on a dot that cannot be of its picture."""
    (x, y), (width, height) = found.position[row].tolist(), found.size[row].tolist()
    return (
        f"{path}: {found.words(row)} at ({x:.1f}, {y:.1f}) px {why} its picture of {width} x {height} px. "
        "Give the size of the pictures in which the dots were measured: `size='1280x960'`."
    )


def _turned_over(points: Float64[np.ndarray, "count 3"], target: Target) -> Float64[np.ndarray, "count 3"]:
    """Return points of a whole grid with the last row first."""
    return points.reshape(target.rows, target.cols, 3)[::-1].reshape(-1, 3)


def _sources(images: list[str], endings: Mapping[str, str], path: Path) -> list[Source]:
    """Return sources from the names of images.

    Raises
    ------
    InputError
        A name fits no ending, or two images are the same view of the same camera.
    """
    sources = [loose_source(image, endings) for image in images]
    first: dict[tuple[str, str], Source] = {}
    for source in sources:
        twin = first.setdefault((source.view, source.camera), source)
        if twin is not source:
            raise InputError(
                f"{path}: {twin.image:.80} and {source.image:.80} are both view '{source.view}' of camera "
                f"'{source.camera}'. Distinguish cameras by the end of the images' names: "
                "`cameras='_0=left,_1=right'`, or give the images different names."
            )
    return sources


def _require_rows_and_columns(target: AnyTarget | Target) -> None:
    """Raise where rows do not stand straight above each other, so that no corners.vnl lists them."""
    if target.rows < 2:  # noqa: PLR2004 -- a row above another
        raise InputError(
            f"A corners.vnl lists a grid of rows and columns, but '{target.name}' has no such grid. Of "
            "boards side by side, convert each by itself."
        )
    places = target.points().reshape(target.rows, target.cols, 3)
    if np.ptp(places[..., 0], axis=0).max() > _EQUAL_PITCH * np.ptp(places[..., 0]):
        raise InputError(
            f"A corners.vnl lists a grid of rows and columns, but the rows of '{target.name}' are shifted "
            "against each other. Use a target that is not asymmetric."
        )


def _require_square(target: AnyTarget) -> None:
    """Raise where mrcal, which knows one spacing, cannot have the target's grid."""
    places = target.points()
    steps = np.diff(places.reshape(target.rows, target.cols, 3), axis=1)[..., :2]
    rises = np.diff(places.reshape(target.rows, target.cols, 3), axis=0)[..., :2]
    pitch = float(steps[0, 0, 0])
    if max(np.abs(steps - [pitch, 0.0]).max(), np.abs(rises - [0.0, pitch]).max()) > _EQUAL_PITCH * pitch:
        raise InputError(
            f"mrcal knows boards with one spacing, along and across, but '{target.name}' is not of that "
            "kind. Use a target with equal pitches."
        )


def _require_plain(image: str) -> None:
    """Raise where an image's name would not be read back."""
    if not image.isascii() or len(image.split()) != 1 or image.startswith("#"):
        raise InputError(
            f"The name '{image}' cannot stand in a corners.vnl, which takes ASCII without spaces. Rename the "
            f"pictures."
        )
