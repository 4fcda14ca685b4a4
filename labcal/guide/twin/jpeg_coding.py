"""JPEG compression as a photograph had it: the same tables of steps and the same sampling of colour."""

import io
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
from jaxtyping import Float32, UInt8

from labcal.shoot.pictures import red_first

_SUFFIXES = {".jpg", ".jpeg"}
_CHANNELS = {"L": 1, "RGB": 3}
_SAMPLED = {0: (1, 1), 1: (2, 1), 2: (2, 2)}
"""Pixels of a row and of a column that share a colour."""


@dataclass(frozen=True)
class JpegCoding:
    """The compression of a JPEG file.

    Attributes
    ----------
    tables : tuple of tuple of int
        Steps of the 64 coefficients of a block, row by row; of brightness, and of colour.
    sampling : int
        Of colour, as Pillow numbers it: 0 for each pixel, 1 for every second one of a row, 2 for every second
        one of a row and of a column.
    channels : int
        1 or 3.
    """

    tables: tuple[tuple[int, ...], ...]
    sampling: int
    channels: int

    @classmethod
    def of(cls, path: Path) -> "JpegCoding | None":
        """Return the compression of a file; None of what is no JPEG, or a form of it not simulated."""
        from PIL import Image, JpegImagePlugin  # noqa: PLC0415 -- takes a tenth of a second

        if path.suffix.lower() not in _SUFFIXES:
            return None
        try:
            with Image.open(path, formats=("JPEG",)) as picture:
                tables: dict[int, list[int]] = getattr(picture, "quantization", {})
                channels = _CHANNELS.get(picture.mode, 0)
                sampling = JpegImagePlugin.get_sampling(picture) if channels > 1 else 0
        except (OSError, ValueError, SyntaxError):
            return None
        if not (tables and channels and sampling >= 0):
            return None
        return cls(tuple(tuple(tables[number]) for number in sorted(tables)), sampling, channels)

    def coded(self, picture: UInt8[np.ndarray, "*shape"]) -> UInt8[np.ndarray, "*shape"]:
        """Return a picture, its colours in the order red, green, blue, as it is read after compression."""
        from PIL import Image  # noqa: PLC0415

        data = io.BytesIO()
        tables = [list(one) for one in self.tables]
        Image.fromarray(picture).save(data, "JPEG", qtables=tables, subsampling=self.sampling)
        flags = cv2.IMREAD_ANYCOLOR | cv2.IMREAD_IGNORE_ORIENTATION
        read = np.asarray(cv2.imdecode(np.frombuffer(data.getbuffer(), np.uint8), flags))
        return red_first(read.astype(np.uint8))

    def sampled(self, values: Float32[np.ndarray, "h w 3"]) -> Float32[np.ndarray, "h w 3"]:
        """Return values, 0 to 255, whose colours passed the coarser sampling of the file, without rounding.

        Colours are averaged, and interpolated as libjpeg does (weights of 3/4 and 1/4 of the nearest two).
        """
        across, down = _SAMPLED[self.sampling]
        height, width = values.shape[:2]
        whole = cv2.copyMakeBorder(values, 0, -height % down, 0, -width % across, cv2.BORDER_REPLICATE)
        split = cv2.cvtColor(whole, cv2.COLOR_RGB2YCrCb)
        full = (whole.shape[1], whole.shape[0])
        small = cv2.resize(split, (full[0] // across, full[1] // down), interpolation=cv2.INTER_AREA)
        split[..., 1:] = cv2.resize(small[..., 1:], full, interpolation=cv2.INTER_LINEAR)
        return np.asarray(cv2.cvtColor(split, cv2.COLOR_YCrCb2RGB)[:height, :width])
