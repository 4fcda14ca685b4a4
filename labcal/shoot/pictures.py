"""Pictures on disk: reading and writing them, with errors that name the file."""

from pathlib import Path

import cv2
import numpy as np

from labcal.errors import InputError, OutputError
from labcal.paths import AnyPath, as_path
from labcal.run.claims import FileOutput
from labcal.run.file_kinds import FileKind
from labcal.run.file_marks import JPEG_COMMENT, PNG_TEXT, TRAILER
from labcal.run.file_reading import read_bytes
from labcal.run.outputs import write_file
from labcal.shoot.exr import read_exr
from labcal.shoot.library_messages import kept_messages
from labcal.shoot.other_formats import CAMERA_RAW, format_advice
from labcal.shoot.picture_header import PictureKind, declared_size, picture_kind, require_sensible_size
from labcal.shoot.picture_stacks import require_one_picture
from labcal.wording import clipped

_LOSSLESS = {".png", ".tif", ".tiff", ".exr", ".bmp", ".pgm", ".ppm", ".pbm", ".pnm"}
_LOSSY = {".jpg", ".jpeg", ".webp"}
SUFFIXES = frozenset({*_LOSSLESS, *_LOSSY})
"""Endings of the pictures that a folder stands for."""
_WRITTEN = {
    ".png": PictureKind.PNG,
    ".jpg": PictureKind.JPEG,
    ".jpeg": PictureKind.JPEG,
    ".tif": PictureKind.TIFF,
    ".tiff": PictureKind.TIFF,
    ".bmp": PictureKind.BMP,
}
_MARKS = {
    PictureKind.PNG: PNG_TEXT,
    PictureKind.JPEG: JPEG_COMMENT,
    PictureKind.TIFF: TRAILER,
    PictureKind.BMP: TRAILER,
}
_JPEG_QUALITY = 95
_IN_WORDS = {b"P1", b"P2", b"P3"}
"""Beginnings of portable pictures whose numbers are written as text."""
MOST_BYTES = 2**30
"""A larger file is not read."""
_TIFF_ERROR = "TIFF_Error"
"""Prefix of messages by which OpenCV reports a strip that libtiff cannot decode."""


def read_picture(path: AnyPath) -> np.ndarray:
    """Read a picture in the orientation in which its camera stored it.

    The pixels are those of the sensor in the order in which they are stored: an orientation that the file
    states in its metadata (EXIF) is not applied. A camera that is turned writes another orientation, but it
    is still the same camera, and a calibration is one of its sensor.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        uint8, uint16 or float32, or in rare TIFF files another type; colour in the order red, green, blue. An
        alpha channel is dropped.

    Raises
    ------
    InputError
        The file cannot be opened, is truncated or damaged, is no picture of a format that is read, holds
        several pictures of one size, or declares a size that no memory is spent on.
    """
    path = as_path(path)
    data = read_bytes(path, "picture", MOST_BYTES)
    if not data:
        raise InputError(f"{path} is not a picture: it is empty (0 bytes). Copy it again.")
    kind = picture_kind(data)
    developed = path.suffix.lower() not in CAMERA_RAW or kind is not PictureKind.TIFF
    advice = None if kind is not None and developed else format_advice(path, data)
    if advice is not None:
        raise InputError(f"{path} is none of {', '.join(PictureKind)}, which labcal reads. {advice}")
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
    require_one_picture(path, data)
    if data[:2] in _IN_WORDS:
        data += b"\n"  # OpenCV wants something behind the last number
    flags = cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION
    try:
        with kept_messages() as said:
            picture = cv2.imdecode(np.frombuffer(data, np.uint8), flags)
    except cv2.error as error:
        raise InputError(f"The picture {path} cannot be decoded: {error}.") from error
    if picture is not None and _TIFF_ERROR in said.text:
        # The library leaves out what it cannot decode, and gives the rest.
        first = said.text.partition(_TIFF_ERROR)[2].partition("\n")[0].strip()
        raise InputError(f"The picture {path} is damaged ({clipped(first)}). Copy it again.")
    if picture is None:
        raise InputError(
            f"{path} is not a picture, or is damaged. Copy it again, or convert it to PNG, JPEG or TIFF."
        )
    return red_first(picture)


def is_lossy(path: AnyPath) -> bool:
    """Tell whether a picture, by its ending, mostly has lost some of its light to compression."""
    return as_path(path).suffix.lower() in _LOSSY


def red_first(picture: np.ndarray) -> np.ndarray:
    """Return a picture of OpenCV's, whose colours begin with blue, in the order red, green, blue.

    Parameters
    ----------
    picture : ndarray, shape (height, width), (height, width, 3) or (height, width, 4)
        An alpha channel is dropped.
    """
    return picture if picture.ndim == 2 else np.ascontiguousarray(picture[..., 2::-1])  # noqa: PLR2004 -- grey


def png_output(path: AnyPath) -> FileOutput:
    """Return a PNG picture as an output of a command.

    Raises
    ------
    OutputError
        The name does not end in ``.png``.
    """
    path = as_path(path)
    if path.suffix.lower() != ".png":
        raise OutputError(f"{path} cannot be written: it would be a PNG. Choose a name that ends in .png.")
    return picture_output(path)


def picture_output(path: AnyPath) -> FileOutput:
    """Return a picture as an output of a command, in the format of the file name ending.

    To be written by :func:`write_single_picture`.

    Raises
    ------
    OutputError
        No format that is written ends so.
    """
    path = as_path(path)
    suffix = path.suffix.lower()
    if suffix not in _WRITTEN:
        raise _unknown_ending(path)
    kind = _WRITTEN[suffix]
    return FileOutput(
        path, FileKind(f"a {kind.value} picture", lambda content: picture_kind(content) is kind, _MARKS[kind])
    )


def write_single_picture(path: AnyPath, picture: np.ndarray, *, force: bool = False) -> None:
    """Write a picture that is an output by itself, with the mark of labcal; else as :func:`write_picture`."""
    path = as_path(path)
    kind = picture_output(path).kind
    write_file(path, encoded_picture(path, picture, _JPEG_QUALITY), kind=kind, force=force)


def write_picture(
    path: AnyPath, picture: np.ndarray, *, jpeg_quality: int = _JPEG_QUALITY, force: bool = False
) -> None:
    """Write a PNG, JPEG or TIFF (uint8, uint16) inside a folder, in the format of its file name ending.

    Parameters
    ----------
    picture : ndarray, shape (height, width) or (height, width, 3)
        Colour in the order red, green, blue.

    Raises
    ------
    OutputError
        The file exists and `force` is not set, or it cannot be written.
    """
    path = as_path(path)
    write_file(path, encoded_picture(path, picture, jpeg_quality), force=force)


def encoded_picture(path: AnyPath, picture: np.ndarray, jpeg_quality: int = _JPEG_QUALITY) -> memoryview:
    """Return the content of a picture's file, in the format of the file name ending.

    Parameters
    ----------
    path : str or os.PathLike
        Only its ending counts.
    picture : ndarray, shape (height, width) or (height, width, 3)
        Colour in the order red, green, blue.

    Raises
    ------
    OutputError
        No format that is written ends so.
    """
    path = as_path(path)
    parameters = [cv2.IMWRITE_JPEG_QUALITY, jpeg_quality] if path.suffix.lower() in {".jpg", ".jpeg"} else []
    ordered = picture if picture.ndim == 2 else picture[..., ::-1]  # noqa: PLR2004 -- grey
    try:
        done, data = cv2.imencode(path.suffix, ordered, parameters)
    except cv2.error:  # it raises for an ending that it does not know
        done = False
    if not done:
        raise _unknown_ending(path)
    return data.data


def through_jpeg(picture: np.ndarray, quality: int) -> np.ndarray:
    """Return a picture as it is read again from a JPEG file, in grey, or red first."""
    data = np.frombuffer(encoded_picture("picture.jpg", picture, quality), np.uint8)
    return red_first(np.asarray(cv2.imdecode(data, cv2.IMREAD_UNCHANGED)))


def _unknown_ending(path: Path) -> OutputError:
    return OutputError(f"{path} cannot be encoded; choose a name that ends in .png, .jpg or .tif.")
