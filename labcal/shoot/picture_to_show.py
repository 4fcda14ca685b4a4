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
        It cannot be read, or its pixels are packed.
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
    raise InputError(
        f"The picture {path} has no header, and its {len(data)} bytes are no {width} x {height} pixels of "
        "one byte or two, but packed ones, which are measured and not shown."
    )
