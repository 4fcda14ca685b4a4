"""Pictures to look at, also those without a header whose pixel format nobody states any more."""

import numpy as np

from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_reading import read_bytes
from labcal.shoot.pictures import MOST_BYTES, read_picture
from labcal.shoot.raw_pictures import RAW_SUFFIXES

_GREYS = 65535.0


def read_picture_to_show(path: AnyPath, size: tuple[int, int] | None) -> np.ndarray:
    """Read a picture; of a file without a header, its bytes or pairs of bytes as greys.

    A mosaic behind a Bayer filter shows as such, and 10 to 16 bits are stretched to the brightest pixel: to
    see which picture it is this is enough, to measure in it is not.

    Parameters
    ----------
    path : str or os.PathLike
    size : (int, int), optional
        Width and height, px, as a table of dots states them.

    Raises
    ------
    InputError
        It cannot be read, or its pixels are packed in 10 or 14 bits.
    """
    path = as_path(path)
    if path.suffix.lower() not in RAW_SUFFIXES or size is None:
        return read_picture(path)
    data, (width, height) = read_bytes(path, "picture", MOST_BYTES), size
    if len(data) == width * height:
        return np.frombuffer(data, dtype=np.uint8).reshape(height, width)
    if len(data) == 2 * width * height:
        greys = np.frombuffer(data, dtype="<u2").reshape(height, width)
        stretched = greys * (_GREYS / max(float(greys.max()), 1.0))
        return stretched.astype(np.uint16)
    if 2 * len(data) == 3 * width * height:
        return _of_pairs(data, height, width)
    raise InputError(
        f"The picture {path} has no header, and its {len(data)} bytes are no {width} x {height} pixels of "
        "one byte, two, or one and a half, so that they are measured and not shown."
    )


def _of_pairs(data: bytes, height: int, width: int) -> np.ndarray:
    """Return the upper 8 bits of pixels of 12 bits, of which two are packed into three bytes.

    The forms Packed and p of GenICam differ in the first pixel of each pair: its upper bits are the first
    byte, or stand in the first byte and the lower half of the second one. The smoother picture is the right
    one.
    """
    first, middle, second = np.frombuffer(data, dtype=np.uint8).reshape(-1, 3).astype(np.uint16).T
    forms = [
        np.column_stack([one, second]).astype(np.uint8).reshape(height, width)
        for one in (first, (middle & 15) << 4 | first >> 4)
    ]
    rough = [np.abs(np.diff(form.astype(np.float32), axis=1)).mean() for form in forms]
    return forms[int(np.argmin(rough))]
