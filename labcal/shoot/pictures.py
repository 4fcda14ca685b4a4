"""Pictures on disk: reading and writing them, with errors that name the file."""

from pathlib import Path

import cv2
import numpy as np

from labcal.errors import InputError, OutputError
from labcal.run.outputs import write_file
from labcal.shoot.exr import read_exr

SUFFIXES = frozenset({".png", ".jpg", ".jpeg", ".tif", ".tiff", ".exr", ".bmp"})


def read_picture(path: Path) -> np.ndarray:
    """Read a picture.

    Returns
    -------
    ndarray, shape (height, width) or (height, width, 3)
        uint8, uint16 or float32; colour in the order red, green, blue. An alpha channel is dropped.

    Raises
    ------
    InputError
        The file cannot be opened, is truncated or is no picture.
    """
    try:
        data = path.read_bytes()
    except OSError as error:
        raise InputError(f"The picture {path} cannot be read: {error.strerror}.") from error
    if path.suffix.lower() == ".exr":
        return read_exr(path)
    if path.suffix.lower() in {".jpg", ".jpeg"} and b"\xff\xd9" not in data[-4096:]:
        raise InputError(
            f"The picture {path} is truncated: a JPEG file must end with its end mark. Copy it again."
        )
    try:
        picture = (
            cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_ANYDEPTH | cv2.IMREAD_ANYCOLOR)
            if data
            else None
        )
    except cv2.error as error:
        raise InputError(f"The picture {path} cannot be decoded: {error}.") from error
    if picture is None:
        raise InputError(
            f"{path} is not a picture, or is damaged. Copy it again, or convert it to PNG, JPEG or TIFF."
        )
    return picture if picture.ndim == 2 else np.ascontiguousarray(picture[..., 2::-1])  # noqa: PLR2004 -- grey


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
        raise OutputError(f"{path} cannot be encoded; choose a name that ends in .png, .jpg or .tif.")
    write_file(path, data.data, force=force)
