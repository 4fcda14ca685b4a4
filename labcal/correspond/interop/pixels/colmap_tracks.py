"""COLMAP's tracks: the observations in ``images.txt``, each of which names the point that it is of.

COLMAP counts pixels from the corner of the first one: here they are half a pixel less.
"""

from collections import Counter
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from labcal.correspond.interop.pixels.exchange import PixelFormat, PixelLines, PixelOptions, ReadPixels
from labcal.correspond.named_pixels_csv import MOST_BYTES
from labcal.correspond.sources import loose_source, refuse_unnamed_cameras
from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.run.file_reading import read_text
from labcal.wording import clipped, counted, printable

_IMAGES = "images.txt"
_HALF_PIXEL = 0.5
_IMAGE_WORDS = 10
_NO_POINT = "-1"
_OF_A_PIXEL = 3


def read_tracks(paths: Sequence[Path], given: PixelOptions) -> ReadPixels:
    """Read ``images.txt``, or the folder of a model; points are called after their POINT3D_ID.

    An observation of no point is left out, and so are those of a point that is observed twice in an image.

    Raises
    ------
    InputError
        There are several files, it is no list of images or damaged, or names tell of several cameras and
        none are given.
    """
    if len(paths) != 1:
        raise InputError("Tracks of COLMAP are one images.txt, or the folder that holds it. Give one.")
    path = paths[0] / _IMAGES if paths[0].is_dir() else paths[0]
    images = _images(path)
    refuse_unnamed_cameras(list(images), given.cameras)
    lines, lost, twice = PixelLines(), 0, 0
    for image, words in images.items():
        source = loose_source(image, given.cameras)
        ids = words[2::_OF_A_PIXEL]
        often = Counter(ids)
        for x, y, point in zip(words[::_OF_A_PIXEL], words[1::_OF_A_PIXEL], ids, strict=True):
            if point == _NO_POINT:
                lost += 1
            elif often[point] > 1:
                twice += 1
            else:
                pixel = (_number(x, image, path) - _HALF_PIXEL, _number(y, image, path) - _HALF_PIXEL)
                lines.add((source.view, source.camera, f"point-{point}"), *pixel)
    notes = [f"{counted(lost, 'pixel')} of no point left out"] if lost else []
    if twice:
        notes.append(f"{counted(twice, 'pixel')} of points that are observed twice in an image left out")
    return ReadPixels(lines.table(), tuple(notes))


def _images(path: Path) -> dict[str, list[str]]:
    """Return the words of the observations of each image by its name."""
    text = read_text(path, "list of images", MOST_BYTES)
    rows = [line.strip() for line in text.splitlines() if not line.lstrip().startswith("#")]
    found: dict[str, list[str]] = {}
    for at in range(0, len(rows), 2):
        if not rows[at] and not any(rows[at + 1 : at + 2]):
            continue
        head = rows[at].split(maxsplit=_IMAGE_WORDS - 1)
        words = rows[at + 1].split() if at + 1 < len(rows) else []
        if len(head) != _IMAGE_WORDS or len(words) % _OF_A_PIXEL or not head[0].isdecimal():
            raise InputError(
                f"{path} is no images.txt of COLMAP, or damaged: '{clipped(printable(rows[at]), 60)}' should "
                "be an image's line, and the next one x, y and POINT3D_ID of its points."
            )
        if found.setdefault(head[-1], words) is not words:
            raise InputError(
                f"{path} lists the image '{clipped(printable(head[-1]))}' twice. Keep one of them."
            )
    if not found:
        raise InputError(f"{path} lists no image.")
    return found


def _number(word: str, image: str, path: Path) -> float:
    """Return a coordinate, px."""
    try:
        value = decimal(word)
    except ValueError:
        value = np.nan
    if not np.isfinite(value):
        raise InputError(
            f"{path} is damaged: '{clipped(printable(word), 20)}' in image '{clipped(image)}' is no pixel."
        )
    return value


COLMAP_TRACKS = PixelFormat(
    "colmap-tracks", "images.txt of a text model, or its folder", ("cameras",), read_tracks
)
