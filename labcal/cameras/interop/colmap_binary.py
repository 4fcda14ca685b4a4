"""COLMAP's binary model: a folder with ``cameras.bin``, ``images.bin``, ``rigs.bin`` and ``frames.bin``.

Little-endian, as ``src/colmap/scene/reconstruction_io_binary.cc`` writes it. Sensors of the type 0 are
cameras. What the numbers mean stands in :mod:`labcal.cameras.interop.colmap_model`.
"""

import struct
from collections.abc import Callable, Sequence
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
from labcal.cameras.interop.numbers_text import finite_numbers, picture_size
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.file_marks import TEXT_COMMENT

_CAMERAS, _IMAGES, _RIGS, _FRAMES = "cameras.bin", "images.bin", "rigs.bin", "frames.bin"
_POINTS = "points3D.bin"
_MODELS = tuple(COUNTS)
_SENSOR = 0
_POINT_BYTES = 24
_MOST = 2**20
"""Of entries in a file."""
Entry = TypeVar("Entry")


class _Bytes:
    """A file's bytes, read from the front."""

    def __init__(self, source: SourceText) -> None:
        self.path = source.path
        self._data = source.data
        self._at = 0

    def take(self, layout: str) -> tuple[int | float, ...]:
        """Return the next numbers, by the layout of :mod:`struct`."""
        size = struct.calcsize(f"<{layout}")
        self.skip(size)
        return struct.unpack_from(f"<{layout}", self._data, self._at - size)

    def whole(self, layout: str) -> int:
        """Return the next whole number."""
        return int(self.take(layout)[0])

    def place(self) -> tuple[float, ...]:
        """Return the next seven numbers, those of a pose."""
        return finite_numbers(self.take(f"{PLACE}d"), (PLACE,), "a pose", self.path)

    def word(self) -> str:
        """Return the text up to the next zero byte."""
        end = self._data.find(b"\0", self._at)
        if end < 0:
            raise self._short()
        word = self._data[self._at : end].decode("utf-8", "replace")
        self._at = end + 1
        return word

    def skip(self, size: int) -> None:
        """Leave bytes out."""
        if size > len(self._data) - self._at:
            raise self._short()
        self._at += size

    def entries(self, entry: Callable[["_Bytes"], Entry]) -> tuple[Entry, ...]:
        """Return all entries of a file, which begins with how many there are."""
        count = self.whole("Q")
        if count > _MOST:
            raise InputError(f"{self.path} is no file of COLMAP: it would have {count} entries.")
        found = tuple(entry(self) for _ in range(count))
        if self._at != len(self._data):
            raise InputError(f"{self.path}: {len(self._data) - self._at} bytes are too many. Copy it again.")
        return found

    def _short(self) -> InputError:
        return InputError(f"{self.path} ends too early. Copy it again.")


def recognises(text: str) -> bool:
    """Tell whether bytes (a character each) are a list of cameras."""
    if "\0" not in text:
        return False
    data = text.encode("latin-1", "replace")
    try:
        return bool(_Bytes(SourceText(Path(), "", data)).entries(_camera))
    except InputError:
        return False


def read_colmap_binary(sources: Sequence[SourceText], _given: ReadOptions = NOTHING_GIVEN) -> ReadRig:
    """Read the files of one folder, or one camera from ``cameras.bin`` alone.

    Raises
    ------
    InputError
        A file is missing or damaged, a camera model has no counterpart, or a camera has more than one place.
    """
    readers = ModelReaders(
        ".bin",
        lambda source: _Bytes(source).entries(_camera),
        lambda source: _Bytes(source).entries(_image),
        lambda source: _Bytes(source).entries(_rig),
        lambda source: _Bytes(source).entries(_frame),
    )
    return rig_of_files({source.path.name: source for source in sources}, readers)


def write_colmap_binary(rig: Rig, _suffix: str) -> RigTexts:
    """Return the five files: one rig in one frame, with one image a camera.

    Raises
    ------
    InputError
        COLMAP has no such lens.
    """
    model = model_of(rig)
    place = f"{PLACE}d"
    cameras = [
        struct.pack(
            f"<IiQQ{len(one.parameters)}d", one.number, _MODELS.index(one.model), *one.size, *one.parameters
        )
        for one in model.cameras
    ]
    images = [
        struct.pack(f"<I{place}I", one.number, *place_of(one.T_cam_world), one.camera)
        + one.name.encode()
        + struct.pack("<xQ", 0)
        for one in model.images
    ]
    rigs = []
    for rig_entry in model.rigs:
        (first, _), *others = rig_entry.T_cam_rig.items()
        rigs.append(struct.pack("<IIiI", rig_entry.number, 1 + len(others), _SENSOR, first))
        rigs += [
            struct.pack(f"<iIB{place}", _SENSOR, at, 1, *place_of(T)) for at, T in others if T is not None
        ]
    frames = [
        struct.pack(f"<II{place}I", one.number, one.rig, *place_of(one.T_rig_world), len(one.images))
        + b"".join(struct.pack("<iIQ", _SENSOR, camera, image) for camera, image in one.images)
        for one in model.frames
    ]
    files: tuple[tuple[str, int, list[bytes]], ...] = (
        (_CAMERAS, len(cameras), cameras),
        (_IMAGES, len(images), images),
        (_POINTS, 0, []),
        (_RIGS, len(model.rigs), rigs),
        (_FRAMES, len(frames), frames),
    )
    return RigTexts(
        tuple(OutputText(name, struct.pack("<Q", count) + b"".join(parts)) for name, count, parts in files)
    )


def _camera(left: _Bytes) -> ModelCamera:
    number, model, width, height = left.take("IiQQ")
    if not 0 <= model < len(_MODELS):
        raise InputError(f"{left.path}: the camera model number {model} has no counterpart here.")
    name = _MODELS[int(model)]
    parameters = left.take(f"{COUNTS[name]}d")
    return ModelCamera(
        int(number),
        name,
        picture_size([int(width), int(height)], left.path),
        finite_numbers(parameters, (COUNTS[name],), f"the parameters of {name}", left.path),
    )


def _image(left: _Bytes) -> ModelImage:
    number = left.whole("I")
    T = placed(left.place(), f"image {number}", left.path)
    camera, name = left.whole("I"), left.word()
    left.skip(_POINT_BYTES * left.whole("Q"))
    return ModelImage(number, camera, name, T)


def _rig(left: _Bytes) -> ModelRig:
    number, count = left.whole("I"), left.whole("I")
    seats = []
    for at in range(count):
        kind, sensor = left.whole("i"), left.whole("I")
        T: Pose | None = np.eye(4) if at == 0 else None  # the first one is the reference
        if at > 0 and left.whole("B"):
            T = placed(left.place(), f"sensor {sensor} of rig {number}", left.path)
        if kind == _SENSOR:
            seats.append((sensor, T))
    return rig_of_seats(number, seats, left.path)


def _frame(left: _Bytes) -> ModelFrame:
    number, rig = left.whole("I"), left.whole("I")
    T_rig_world = placed(left.place(), f"frame {number}", left.path)
    images = []
    for _ in range(left.whole("I")):
        kind, sensor, image = left.whole("i"), left.whole("I"), left.whole("Q")
        if kind == _SENSOR:
            images.append((sensor, image))
    return ModelFrame(number, rig, T_rig_world, tuple(images))


COLMAP_BINARY = RigFormat(
    "colmap-binary",
    (".bin",),
    Home.FOLDER,
    2**28,
    recognises,
    read_colmap_binary,
    write_colmap_binary,
    TEXT_COMMENT,
    binary=True,
)
