"""COLMAP's text model: a folder with ``cameras.txt``, ``images.txt``, ``rigs.txt`` and ``frames.txt``.

``rigs.txt`` and ``frames.txt`` are of COLMAP 3.12 and later; older models have none, and older programs skip
them. What the numbers mean stands in :mod:`labcal.cameras.interop.colmap_model`. Lines are read as
``src/colmap/scene/reconstruction_io_text.cc`` reads them: behind each image one line lists its points.
"""

import re
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import TypeVar

import numpy as np

from labcal.arrays import Pose
from labcal.cameras.interop.colmap_lenses import COUNTS
from labcal.cameras.interop.colmap_model import (
    PLACE,
    ModelCamera,
    ModelFrame,
    ModelImage,
    ModelReaders,
    ModelRig,
    model_of,
    place_of,
    placed,
    rig_of_files,
    rig_of_seats,
)
from labcal.cameras.interop.exchange import (
    NOTHING_GIVEN,
    Home,
    OutputText,
    ReadOptions,
    ReadRig,
    RigFormat,
    RigTexts,
    SourceText,
)
from labcal.cameras.interop.numbers_text import finite_numbers, is_number, number_text, picture_size
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.file_marks import TEXT_COMMENT

_CAMERAS, _IMAGES, _RIGS, _FRAMES = "cameras.txt", "images.txt", "rigs.txt", "frames.txt"
_POINTS = "points3D.txt"
_CAMERA_LINE = rf"^\d+\s+({'|'.join(COUNTS)})\s+\d+\s+\d+\s|CAMERA_ID, MODEL, WIDTH, HEIGHT"
_SENSOR = "CAMERA"
_SENSORS, _DATA = (f"{what}[] as (SENSOR_TYPE, SENSOR_ID," for what in ("SENSORS", "DATA_IDS"))
_OF_A_POINT = 3
_MOST_DIGITS = 19
"""Of a number of 64 bits."""
Entry = TypeVar("Entry")


def recognises(text: str) -> bool:
    """Tell whether a text is a list of cameras."""
    return re.search(_CAMERA_LINE, text, re.MULTILINE) is not None


def read_colmap(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read the texts of one folder, or one camera from ``cameras.txt`` alone.

    Raises
    ------
    InputError
        A file is missing or damaged, a camera model has no counterpart, or a camera has more than one place.
    """
    by_name = {source.path.name: source for source in sources}
    if _CAMERAS not in by_name and len(sources) == 1 and recognises(sources[0].text):
        by_name = {_CAMERAS: sources[0]}
    readers = ModelReaders(
        ".txt",
        lambda source: _entries(source, _camera),
        _images,
        lambda source: _entries(source, _rig),
        lambda source: _entries(source, _frame),
    )
    return rig_of_files(by_name, readers)


def write_colmap(rig: Rig, _suffix: str) -> RigTexts:
    """Return the five texts: one rig in one frame, with one image a camera.

    Raises
    ------
    InputError
        COLMAP has no such lens.
    """
    model = model_of(rig)
    cameras = [
        f"{one.number} {one.model} {one.size[0]} {one.size[1]} {_words(one.parameters)}"
        for one in model.cameras
    ]
    images = [
        f"{one.number} {_words(place_of(one.T_cam_world))} {one.camera} {one.name}\n" for one in model.images
    ]
    rigs = []
    for one in model.rigs:
        (first, _), *others = one.T_cam_rig.items()
        seats = [f" {_SENSOR} {at} 1 {_words(place_of(T))}" for at, T in others if T is not None]
        rigs.append(f"{one.number} {1 + len(others)} {_SENSOR} {first}{''.join(seats)}")
    frames = [
        f"{one.number} {one.rig} {_words(place_of(one.T_rig_world))} {len(one.images)}"
        + "".join(f" {_SENSOR} {camera} {image}" for camera, image in one.images)
        for one in model.frames
    ]
    place = "QW, QX, QY, QZ, TX, TY, TZ"
    texts: tuple[tuple[str, str, list[str]], ...] = (
        (_CAMERAS, "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]", cameras),
        (_IMAGES, f"# IMAGE_ID, {place}, CAMERA_ID, NAME\n# POINTS2D[] as (X, Y, POINT3D_ID)", images),
        (_POINTS, "# POINT3D_ID, X, Y, Z, R, G, B, ERROR, TRACK[] as (IMAGE_ID, POINT2D_IDX)", []),
        (
            _RIGS,
            f"# RIG_ID, NUM_SENSORS, REF_SENSOR_TYPE, REF_SENSOR_ID, {_SENSORS} HAS_POSE, [{place}])",
            rigs,
        ),
        (
            _FRAMES,
            f"# FRAME_ID, RIG_ID, RIG_FROM_WORLD[{place}], NUM_DATA_IDS, {_DATA} DATA_ID)",
            frames,
        ),
    )
    return RigTexts(tuple(OutputText(name, "\n".join([head, *lines]) + "\n") for name, head, lines in texts))


def _words(values: Sequence[float]) -> str:
    return " ".join(number_text(value) for value in values)


def _entries(source: SourceText, entry: Callable[[Iterator[str], Path], Entry]) -> list[Entry]:
    """Return what stands in the lines that are no comments; each is used up to its last word."""
    found = []
    for line in source.text.split("\n"):
        words = line.split()
        if not words or words[0].startswith("#"):
            continue
        left = iter(words)
        try:
            found.append(entry(left, source.path))
        except StopIteration:
            raise InputError(f"{source.path}: the line '{line.strip():.60}' ends too early.") from None
        surplus = next(left, None)
        if surplus is not None:
            raise InputError(f"{source.path}: '{surplus:.40}' is too much in the line '{line.strip():.60}'.")
    return found


def _whole(words: Iterator[str], what: str, path: Path) -> int:
    """Return a number of a thing, or how many there are."""
    word = next(words)
    if not (word.isascii() and word.isdigit() and len(word) <= _MOST_DIGITS):
        raise InputError(f"{path}: {what} should be a whole number, but is '{word:.40}'.")
    return int(word)


def _camera(words: Iterator[str], path: Path) -> ModelCamera:
    """Return the camera of one line."""
    number, model = _whole(words, "a CAMERA_ID", path), next(words)
    size = picture_size([next(words), next(words)], path)
    rest = list(words)
    count = COUNTS.get(model, len(rest))
    return ModelCamera(
        number, model, size, finite_numbers(rest, (count,), f"the parameters of {model}", path)
    )


def _place(words: Iterator[str], path: Path) -> tuple[float, ...]:
    return finite_numbers([next(words) for _ in range(PLACE)], (PLACE,), "a pose", path)


def _sensor(words: Iterator[str], path: Path) -> tuple[bool, int]:
    """Return whether a sensor is a camera, and its number."""
    return next(words) == _SENSOR, _whole(words, "a SENSOR_ID", path)


def _rig(words: Iterator[str], path: Path) -> ModelRig:
    """Return the rig of one line."""
    number, count = _whole(words, "a RIG_ID", path), _whole(words, "NUM_SENSORS", path)
    seats = []
    for at in range(count):
        is_camera, sensor = _sensor(words, path)
        T: Pose | None = np.eye(4) if at == 0 else None  # the first one is the reference
        if at > 0 and _whole(words, "HAS_POSE", path) == 1:
            T = placed(_place(words, path), f"sensor {sensor} of rig {number}", path)
        if is_camera:
            seats.append((sensor, T))
    return rig_of_seats(number, seats, path)


def _frame(words: Iterator[str], path: Path) -> ModelFrame:
    """Return the frame of one line."""
    number, rig = _whole(words, "a FRAME_ID", path), _whole(words, "a RIG_ID", path)
    T_rig_world = placed(_place(words, path), f"frame {number}", path)
    images = []
    for _ in range(_whole(words, "NUM_DATA_IDS", path)):
        is_camera, sensor = _sensor(words, path)
        image = _whole(words, "a DATA_ID", path)
        if is_camera:
            images.append((sensor, image))
    return ModelFrame(number, rig, T_rig_world, tuple(images))


def _images(source: SourceText) -> Iterator[ModelImage]:
    """Return the images; behind each one line lists its points, and may be empty."""
    lines = iter(source.text.split("\n"))
    for line in lines:
        words = line.split(maxsplit=PLACE + 2)
        if not words or words[0].startswith("#"):
            continue
        if len(words) != PLACE + 3:
            raise InputError(f"{source.path}: '{line.strip():.60}' is no line of an image.")
        left = iter(words)
        number = _whole(left, "an IMAGE_ID", source.path)
        T = placed(_place(left, source.path), f"image {number}", source.path)
        camera, name = _whole(left, "a CAMERA_ID", source.path), next(left).strip()
        points = next(lines, "").split()
        if len(points) % _OF_A_POINT or not all(map(is_number, points)):
            raise InputError(
                f"{source.path}: behind the line of {name:.60} there should be one that lists its points, "
                "which may be empty."
            )
        yield ModelImage(number, camera, name, T)


COLMAP = RigFormat(
    "colmap", (".txt",), Home.FOLDER, 2**26, recognises, read_colmap, write_colmap, TEXT_COMMENT
)
