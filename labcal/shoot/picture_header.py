"""The header of a picture file, read before anything is decoded."""

import re
import struct
from enum import StrEnum
from pathlib import Path

from labcal.errors import InputError

MOST_PIXELS = 2**26
"""A larger picture is not decoded: detection takes some tens of bytes for each."""
FREELY = 2**23
MOST_PIXELS_A_BYTE = 400
"""A picture beyond `FREELY` pixels that is packed more tightly is empty, or made to fill the memory."""


class PictureKind(StrEnum):
    """Formats that labcal reads, identified by the first bytes of the file, not by its name."""

    PNG = "PNG"
    JPEG = "JPEG"
    TIFF = "TIFF"
    BMP = "BMP"
    PNM = "PGM or PPM"
    WEBP = "WebP"
    EXR = "OpenEXR"


_BEGINNINGS = (
    (b"\x89PNG\r\n\x1a\n", PictureKind.PNG),
    (b"\xff\xd8\xff", PictureKind.JPEG),
    (b"II*\0", PictureKind.TIFF),
    (b"MM\0*", PictureKind.TIFF),
    (b"II+\0", PictureKind.TIFF),
    (b"MM\0+", PictureKind.TIFF),
    (b"BM", PictureKind.BMP),
    (b"\x76\x2f\x31\x01", PictureKind.EXR),
)
_PNM = re.compile(rb"P[1-6](?:\s|#[^\n\r]*[\n\r])+(\d{1,9})(?:\s|#[^\n\r]*[\n\r])+(\d{1,9})\s")
"""The beginning of a portable bitmap, graymap or pixmap: its kind, comments, width and height."""
_PNM_HEADER = 4096  # bytes, comments included
_WEBP = re.compile(rb"RIFF.{4}WEBPVP8[ LX]", re.DOTALL)
_WEBP_HEADER = 30
_BIG_TIFF = 43
_WIDTH, _HEIGHT = 256, 257  # TIFF's tags
_SHORT, _LONG, _LONG8 = 3, 4, 16  # and their types
_JPEG_FRAMES = frozenset({*range(0xC0, 0xD0)} - {0xC4, 0xC8, 0xCC})
_JPEG_BARE = frozenset({0x01, *range(0xD0, 0xD9)})  # markers without a length
_OS2_HEADER = 12


def picture_kind(data: bytes) -> PictureKind | None:
    """Return the format of a file, or None if labcal does not read it."""
    if _PNM.match(data[:_PNM_HEADER]):
        return PictureKind.PNM
    if _WEBP.match(data[:16]):
        return PictureKind.WEBP
    return next((kind for beginning, kind in _BEGINNINGS if data.startswith(beginning)), None)


def declared_size(data: bytes) -> tuple[int, int] | None:
    """Return width and height (px) from the header of any file but OpenEXR's.

    Returns
    -------
    (int, int) or None
        None where the header is damaged, or the format another one.
    """
    readers = {
        PictureKind.PNG: _png_size,
        PictureKind.JPEG: _jpeg_size,
        PictureKind.TIFF: _tiff_size,
        PictureKind.BMP: _bmp_size,
        PictureKind.PNM: _pnm_size,
        PictureKind.WEBP: _webp_size,
    }
    reader = readers.get(picture_kind(data))  # type: ignore[arg-type]
    try:
        return None if reader is None else reader(data)
    except struct.error:  # the file ends within its header
        return None


def require_sensible_size(path: Path, size: tuple[int, int] | None, length: int) -> None:
    """Raise if a header states no size, or one that is too large.

    Parameters
    ----------
    path : Path
        For the message.
    size : (int, int) or None
        Width and height as declared, px.
    length : int
        Of the file, bytes.

    Raises
    ------
    InputError
        There is no size, there are no pixels, or too many for any camera or for so short a file.
    """
    damaged = f"{path} is not a picture, or is damaged"
    if size is None:
        raise InputError(f"{damaged}: it does not state its size. Copy it again.")
    width, height = size
    pixels = width * height
    if pixels == 0:
        raise InputError(f"{damaged}: it declares {width} x {height} pixels. Copy it again.")
    if pixels > MOST_PIXELS:
        raise InputError(
            f"The picture {path} declares {width} x {height} pixels, more than {MOST_PIXELS} in all. If that "
            "is no mistake, scale it down, or cut out what shows the target."
        )
    if pixels > FREELY and pixels > MOST_PIXELS_A_BYTE * length:
        raise InputError(
            f"The picture {path} declares {width} x {height} pixels in {length} bytes: it is all of one "
            "colour, or made to fill the memory."
        )


def _png_size(data: bytes) -> tuple[int, int] | None:
    """Read the chunk IHDR, which must be the first."""
    if data[12:16] != b"IHDR":
        return None
    width, height = struct.unpack_from(">II", data, 16)
    return width, height


def _jpeg_size(data: bytes) -> tuple[int, int] | None:
    """Read the first frame header, which follows any number of segments with a length each."""
    at = 2
    while at + 4 <= len(data):
        if data[at] != 0xFF:  # noqa: PLR2004 -- a marker begins so
            return None
        marker = data[at + 1]
        if marker == 0xFF:  # noqa: PLR2004 -- and may be filled up
            at += 1
        elif marker in _JPEG_BARE:
            at += 2
        elif marker in _JPEG_FRAMES:
            height, width = struct.unpack_from(">HH", data, at + 5)
            return width, height
        else:
            at += 2 + struct.unpack_from(">H", data, at + 2)[0]
    return None


def _tiff_size(data: bytes) -> tuple[int, int] | None:
    """Read width and height in the first directory, of TIFF or BigTIFF."""
    order = "<" if data[:2] == b"II" else ">"
    big = struct.unpack_from(order + "H", data, 2)[0] == _BIG_TIFF
    (first,) = struct.unpack_from(order + ("Q" if big else "I"), data, 8 if big else 4)
    if first > len(data):
        return None
    (count,) = struct.unpack_from(order + ("Q" if big else "H"), data, first)
    entry, values = (20, 12) if big else (12, 8)
    at = first + (8 if big else 2)
    found = {}
    for number in range(min(count, 4096)):
        tag, kind = struct.unpack_from(order + "HH", data, at + number * entry)
        form = {_SHORT: "H", _LONG: "I", _LONG8: "Q"}.get(kind)
        if tag in {_WIDTH, _HEIGHT} and form is not None:
            (found[tag],) = struct.unpack_from(order + form, data, at + number * entry + values)
    return (found[_WIDTH], found[_HEIGHT]) if len(found) == 2 else None  # noqa: PLR2004 -- both


def _bmp_size(data: bytes) -> tuple[int, int] | None:
    """Read the header behind that of the file; the height is negative if rows run downwards."""
    (length,) = struct.unpack_from("<I", data, 14)
    width, height = struct.unpack_from("<HH" if length == _OS2_HEADER else "<ii", data, 18)
    return (width, abs(height)) if width > 0 else None


def _pnm_size(data: bytes) -> tuple[int, int] | None:
    """Read width and height, which are written as text."""
    found = _PNM.match(data[:_PNM_HEADER])
    return None if found is None else (int(found[1]), int(found[2]))


def _webp_size(data: bytes) -> tuple[int, int] | None:
    """Read the first chunk: of a lossy picture, of a lossless one, or of one with further chunks."""
    form = data[12:16]
    if len(data) < _WEBP_HEADER:
        return None
    if form == b"VP8X":
        width, height = (int.from_bytes(data[at : at + 3], "little") + 1 for at in (24, 27))
    elif form == b"VP8L":
        (bits,) = struct.unpack_from("<I", data, 21)
        width, height = (bits & 0x3FFF) + 1, (bits >> 14 & 0x3FFF) + 1
    else:
        width, height = (side & 0x3FFF for side in struct.unpack_from("<HH", data, 26))
    return width, height
