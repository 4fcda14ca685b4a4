"""Reading of one file of cameras: of sensible size, in whichever of the usual forms its text is stored."""

import codecs
import re
import zlib
from pathlib import Path

from labcal.cameras.interop.exchange import SourceText
from labcal.cameras.interop.numpy_archive import ZIP, is_archive
from labcal.errors import InputError
from labcal.run.file_reading import read_bytes

_GZIP = b"\x1f\x8b"
_TAR, _TAR_AT = b"ustar", 257
_STRANGE_SPACE = re.compile(r"[^\S \t\r\n\f\v]")
"""Spaces of other kinds, which YAML and Python pass over: a damaged minus sign of a number may be one."""
_UTF_16 = (codecs.BOM_UTF16_LE, codecs.BOM_UTF16_BE)


def read_source(path: Path, most: int) -> SourceText:
    """Read a file; what OpenCV has compressed (``.yml.gz``) is unpacked.

    Parameters
    ----------
    path : Path
    most : int
        Bytes that it may have, packed or not.

    Raises
    ------
    InputError
        It cannot be read, it is too large, damaged, or an archive of several files.
    """
    data = read_bytes(path, "file", most)
    if data.startswith(_GZIP):
        data = _unpacked(data, path, most)
    if data[_TAR_AT : _TAR_AT + len(_TAR)] == _TAR:
        raise InputError(
            f"{path} is an archive (tar), as calibrationdata.tar.gz of ROS is. Unpack it, and convert "
            "ost.yaml, or left.yaml and right.yaml, in it."
        )
    if data.startswith(_UTF_16):
        try:
            data = data.decode("utf-16").encode()
        except UnicodeError as error:
            raise InputError(f"{path} begins as UTF-16, but is none. Save it as UTF-8.") from error
    text = data.decode("latin-1") if b"\0" in data else _text(data)
    if text.startswith(ZIP) and not is_archive(text):
        raise InputError(
            f"{path} is an archive (zip), as a .z3d of VIC-3D is. Unpack it, and convert the file of cameras "
            "in it, which VIC-3D calls project.xml or calibration.xml."
        )
    return SourceText(path, text, data)


def _text(data: bytes) -> str:
    """Return the text of a file that is no binary one: in UTF-8, or with single bytes for umlauts."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        text = data.decode("latin-1")
    return _STRANGE_SPACE.sub("\ufffd", text)


def _unpacked(data: bytes, path: Path, most: int) -> bytes:
    """Return the content of a file that gzip has packed."""
    machine = zlib.decompressobj(wbits=31)
    try:
        content = machine.decompress(data, most)
    except zlib.error as error:
        raise InputError(f"{path} is damaged: {error}. Copy it again.") from error
    if not machine.eof:
        raise InputError(f"{path} is truncated, or there are more than {most} bytes in it. Copy it again.")
    return content
