"""Pictures on disk: reading and writing them, with errors that name the file."""

import stat
from pathlib import Path

import cv2
import numpy as np

from labcal.errors import InputError, OutputError
from labcal.run.claims import FileKind, FileOutput
from labcal.run.outputs import write_file
from labcal.shoot.exr import read_exr
from labcal.shoot.picture_header import PictureKind, declared_size, picture_kind, require_sensible_size

SUFFIXES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".bmp"})
_WRITTEN = {
    ".png": PictureKind.PNG,
    ".jpg": PictureKind.JPEG,
    ".jpeg": PictureKind.JPEG,
    ".tif": PictureKind.TIFF,
    ".tiff": PictureKind.TIFF,
    ".bmp": PictureKind.BMP,
}
MOST_BYTES = 2**30
"""A larger file is not read."""


def read_picture(path: Path) -> np.ndarray:
    """Read a picture, as its camera stored it.

    The pixels are those of the sensor in the order in which they are stored: an orientation that the file
    states beside them (EXIF) is not applied. A camera that is turned writes another orientation, but it is
    still the same camera, and a calibration is one of its sensor. Of a file with several pictures the first
    one is read.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        uint8, uint16 or float32, or in rare TIFF files another type; colour in the order red, green, blue. An
        alpha channel is dropped.

    Raises
    ------
    InputError
        The file cannot be opened, is truncated or damaged, is no picture of a format that is read, or
        declares a size that no memory is spent on.
    """
    data = _bytes(path)
    kind = picture_kind(data)
    if kind is None:
        raise InputError(
            f"{path} is not a picture, or is damaged: it begins as none of {', '.join(PictureKind)} do. Copy "
            "it again, or convert it to one of these."
        )
    if kind is PictureKind.EXR:
        return read_exr(path)
    if kind is PictureKind.JPEG and b"\xff\xd9" not in data[-4096:]:
        raise InputError(
            f"The picture {path} is truncated: a JPEG file must end with its end mark. Copy it again."
        )
    require_sensible_size(path, declared_size(data), len(data))
    flags = cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        picture = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error as error:
        raise InputError(f"The picture {path} cannot be decoded: {error}.") from error
    if picture is None:
        raise InputError(
            f"{path} is not a picture, or is damaged. Copy it again, or convert it to PNG, JPEG or TIFF."
        )
    return picture if picture.ndim == 2 else np.ascontiguousarray(picture[..., 2::-1])  # noqa: PLR2004 -- grey


def _bytes(path: Path) -> bytes:
    """Read a file whole; no folder, no pipe and no device."""
    try:
        status = path.stat()
        if not stat.S_ISREG(status.st_mode):
            raise InputError(f"The picture {path} cannot be read: it is no file.")
        if status.st_size > MOST_BYTES:
            raise InputError(
                f"The picture {path} is not read: its {status.st_size} bytes are more than {MOST_BYTES}."
            )
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"The picture {path} cannot be read: {error.strerror}.") from error


def picture_output(path: Path) -> FileOutput:
    """Return a picture as an output of a command, the format by the ending; see :func:`write_picture`.

    Raises
    ------
    OutputError
        No format that is written ends so.
    """
    suffix = path.suffix.lower()
    if suffix not in _WRITTEN:
        raise _unknown_ending(path)
    kind = _WRITTEN[suffix]
    return FileOutput(
        path, FileKind(f"a {kind.value} picture", lambda content: picture_kind(content) is kind)
    )


def write_picture(path: Path, picture: np.ndarray, *, jpeg_quality: int = 95, force: bool = False) -> None:
    """Write a PNG, JPEG or TIFF (uint8, uint16), the format by the ending.

    Parameters
    ----------
    picture : ndarray, shape (height, width) or (height, width, 3)
        Colour in the order red, green, blue.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    """
    ordered = picture if picture.ndim == 2 else picture[..., ::-1]  # noqa: PLR2004 -- grey
    parameters = [cv2.IMWRITE_JPEG_QUALITY, jpeg_quality] if path.suffix.lower() in {".jpg", ".jpeg"} else []
    try:
        done, data = cv2.imencode(path.suffix, ordered, parameters)
    except cv2.error:  # it raises for an ending that it does not know
        done = False
    if not done:
        raise _unknown_ending(path)
    write_file(path, data.data, force=force)


def _unknown_ending(path: Path) -> OutputError:
    return OutputError(f"{path} cannot be encoded; choose a name that ends in .png, .jpg or .tif.")
