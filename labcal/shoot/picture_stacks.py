"""Files that hold several pictures: stacks of TIFF, and animations of PNG and WebP."""

import struct
from pathlib import Path

from labcal.errors import InputError
from labcal.shoot.picture_header import PictureKind, picture_kind

_BIG_TIFF = 43
_SUBFILE, _WIDTH, _HEIGHT = 254, 256, 257  # TIFF's tags
_SMALLER_OR_MASK = 0b101
"""Bits of TIFF's NewSubfileType: a picture of lower resolution of another one, or its mask."""
_MOST_DIRECTORIES = 100_000
_MOST_ENTRIES = 4096
_FORMS = {1: "B", 3: "H", 4: "I", 16: "Q"}
_ANIMATION = 0x02
"""Bit of the flags of an extended WebP."""


def require_one_picture(path: Path, data: bytes) -> None:
    """Raise where a file holds several pictures, of which any one could be meant.

    Pictures that a TIFF calls smaller ones of another, or whose size is not that of the first one, such as
    thumbnails, do not count.

    Raises
    ------
    InputError
        It does; the message states how many, and how to split the file.
    """
    count = _count(data)
    if count > 1:
        raise InputError(
            f"{path} holds {count} pictures, and it is not known which one is meant. Split it, each into a "
            f"file of its own (ImageMagick: magick {path.name} {path.stem}-%03d.png)."
        )


def _count(data: bytes) -> int:
    """Return the number of whole pictures in a file; 1 where its structure is damaged."""
    kind = picture_kind(data)
    try:
        if kind is PictureKind.TIFF:
            return _tiff_pages(data)
        if kind is PictureKind.PNG:
            return _png_frames(data)
        if kind is PictureKind.WEBP:
            return _webp_frames(data)
    except struct.error:  # the file ends within a header
        return 1
    return 1


def _tiff_pages(data: bytes) -> int:
    """Return the number of directories whose picture is as large as the first one."""
    order = "<" if data[:2] == b"II" else ">"
    big = struct.unpack_from(order + "H", data, 2)[0] == _BIG_TIFF
    place, number, entry, values = ("Q", "Q", 20, 12) if big else ("I", "H", 12, 8)
    (at,) = struct.unpack_from(order + place, data, 8 if big else 4)
    seen: set[int] = set()
    sizes = []
    while at and at not in seen and len(seen) < _MOST_DIRECTORIES:
        seen.add(at)
        (count,) = struct.unpack_from(order + number, data, at)
        first = at + struct.calcsize(order + number)
        tags = {}
        for row in range(min(count, _MOST_ENTRIES)):
            tag, kind = struct.unpack_from(order + "HH", data, first + row * entry)
            if tag in {_SUBFILE, _WIDTH, _HEIGHT} and kind in _FORMS:
                (tags[tag],) = struct.unpack_from(order + _FORMS[kind], data, first + row * entry + values)
        if not tags.get(_SUBFILE, 0) & _SMALLER_OR_MASK:
            sizes.append((tags.get(_WIDTH), tags.get(_HEIGHT)))
        (at,) = struct.unpack_from(order + place, data, first + count * entry)
    return max(1, sizes.count(sizes[0])) if sizes else 1


def _png_frames(data: bytes) -> int:
    """Return the number of frames that the chunk acTL states; it stands before the picture's."""
    at = 8
    while at + 8 <= len(data):
        length, name = struct.unpack_from(">I4s", data, at)
        if name == b"acTL":
            return int(struct.unpack_from(">I", data, at + 8)[0])
        if name in {b"IDAT", b"IEND"}:
            break
        at += 12 + length
    return 1


def _webp_frames(data: bytes) -> int:
    """Return the number of frames of an animation."""
    if data[12:16] != b"VP8X" or not data[20] & _ANIMATION:
        return 1
    at, frames = 12, 0
    while at + 8 <= len(data):
        name, length = struct.unpack_from("<4sI", data, at)
        frames += name == b"ANMF"
        at += 8 + length + length % 2
    return max(1, frames)
