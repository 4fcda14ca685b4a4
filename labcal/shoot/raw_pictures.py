"""Pictures as sensors give them: pixels packed without a header, and mosaics behind a Bayer filter."""

import re
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.errors import InputError
from labcal.paths import AnyPath, as_path
from labcal.run.file_reading import read_bytes
from labcal.shoot.picture_header import MOST_PIXELS, picture_kind
from labcal.shoot.pictures import MOST_BYTES, read_picture

RAW_SUFFIXES = frozenset({".raw", ".bin"})
"""Endings of files without a header, in a folder."""
_FORM = re.compile(r"(Mono|Bayer(?:RG|GR|GB|BG))(8|10|12|14|16|10p|12p|10Packed|12Packed)(?::(\d+)x(\d+))?")
_WHOLE_BYTE = 8
_BURNT_SHARE = 0.01
"""More pixels of a colour than this with the largest value of all are burnt out."""
_OTHER_GREENS, _TIMES_ALIKE = 0.05, 4.0
"""Difference of the means of two greens, over the largest mean, that no mosaic has; and how many times that
of red and blue it is where these are the greens."""
_CORNERS = {"RG": "RGGB", "GR": "GRBG", "GB": "GBRG", "BG": "BGGR"}


@dataclass(frozen=True)
class RawFormat:
    """A pixel format, by the names of GenICam's Pixel Format Naming Convention.

    Attributes
    ----------
    pattern : str or None
        First two colours of a Bayer mosaic: ``RG``, ``GR``, ``GB`` or ``BG``; None for grey.
    bits : int
        Bits of a pixel.
    packing : str
        Empty: each pixel in one byte, or in two, the lower one first. ``p``: without gaps, the lower bits
        first. ``Packed``: as GigE Vision packs two pixels of 10 or 12 bits in three bytes.
    size : (int, int) or None
        Width and height, px, which a file without a header does not tell.
    """

    pattern: str | None
    bits: int
    packing: str
    size: tuple[int, int] | None


def parse_raw_format(text: str) -> RawFormat:
    """Return a pixel format from its name: ``BayerRG8``, ``Mono12p:1280x1024``.

    Raises
    ------
    InputError
        It is none.
    """
    found = _FORM.fullmatch(_by_genicam(text))
    if found is None:
        raise InputError(
            "`raw` takes a pixel format, Mono or BayerRG, BayerGR, BayerGB, BayerBG with 8, 10, 12, 14, 16, "
            "10p, 12p, 10Packed or 12Packed, and the size of files without a header, as in 'BayerRG8' or "
            f"'Mono12p:1280x1024', but got '{text}'."
        )
    colours, depth, width, height = found.groups()
    packing = depth.lstrip("0123456789")
    bits = int(depth.removesuffix(packing))
    size = None if width is None else (int(width), int(height))
    if size is not None and not 0 < size[0] * size[1] <= MOST_PIXELS:
        raise InputError(f"`raw` states {size[0]} x {size[1]} pixels, which no picture has.")
    return RawFormat(colours.removeprefix("Bayer") if colours != "Mono" else None, bits, packing, size)


def _by_genicam(text: str) -> str:
    """Return GenICam's name of a pixel format that is written in other cases, or as ROS does: bayer_rggb8."""
    name, colon, size = text.strip().partition(":")
    name = re.sub(r"(?i)^bayer_(rg|gr|gb|bg)[rgb]{2}", lambda found: f"Bayer{found[1].upper()}", name)
    name = re.sub(r"(?i)^(bayer)(rg|gr|gb|bg)", lambda found: f"Bayer{found[2].upper()}", name)
    name = re.sub(r"(?i)^mono", "Mono", re.sub(r"(?i)packed$", "Packed", re.sub(r"P$", "p", name)))
    return name + colon + size.lower()


def read_raw_picture(path: AnyPath, raw: RawFormat) -> np.ndarray:
    """Read a picture of a pixel format: a file without a header, or a grey picture that holds a mosaic.

    Returns
    -------
    ndarray, shape (height, width)
        uint8 or uint16; a mosaic is balanced, see :func:`balanced_mosaic`.

    Raises
    ------
    InputError
        The file cannot be read, is not as long as the format and the size say, or holds colours already.
    """
    path = as_path(path)
    data = read_bytes(path, "picture", MOST_BYTES)
    if picture_kind(data) is None:
        picture = _unpacked(path, np.frombuffer(data, dtype=np.uint8), raw)
    else:
        picture = read_picture(path)
    if raw.pattern is None:
        return picture
    if picture.ndim != 2 or picture.dtype not in (np.uint8, np.uint16):  # noqa: PLR2004 -- grey
        raise InputError(
            f"The picture {path} holds no mosaic: it has colours already, or no whole numbers. Leave out "
            "`raw`."
        )
    _refuse_other_pattern(path, picture, raw.pattern)
    return balanced_mosaic(picture, raw.pattern)


def _refuse_other_pattern(path: Path, mosaic: np.ndarray, pattern: str) -> None:
    """Raise where the two greens of a pattern differ, and its red and blue are alike as greens are."""
    means = [float(mosaic[i::2, j::2].mean()) for i in (0, 1) for j in (0, 1)]
    green = [mean for mean, colour in zip(means, _CORNERS[pattern], strict=True) if colour == "G"]
    other = [mean for mean, colour in zip(means, _CORNERS[pattern], strict=True) if colour != "G"]
    apart, alike = abs(green[0] - green[1]), abs(other[0] - other[1])
    if apart > _OTHER_GREENS * max(means) and alike < apart / _TIMES_ALIKE:
        turned = {"RG": "BayerGR or BayerGB", "BG": "BayerGR or BayerGB"}.get(pattern, "BayerRG or BayerBG")
        raise InputError(
            f"The mosaic of {path} is not Bayer{pattern}: what would be its two greens differ by "
            f"{100 * apart / max(green):.0f}%, and its red and blue are alike. Name another one, {turned}."
        )


def balanced_mosaic(mosaic: np.ndarray, pattern: str) -> np.ndarray:
    """Return a Bayer mosaic whose colours have one mean, so that what is grey has one value.

    Targets are black and white: their mosaic is then a grey picture at every pixel. To interpolate colours
    would add nothing, and its errors at edges would move dots.

    Parameters
    ----------
    mosaic : ndarray of uint8 or uint16, shape (height, width)
    pattern : str
        ``RG``, ``GR``, ``GB`` or ``BG``: its first two colours.

    Returns
    -------
    ndarray, shape (height, width)
        Of the same type; the darker colours are scaled up to the brightest one, which tells the exposure, and
        cut off at the end of the range. Where the brightest one is burnt out, all are cut off at its value.
    """
    phases = {(i, j): mosaic[i::2, j::2] for i in (0, 1) for j in (0, 1)}
    colours = dict(zip(phases, _CORNERS[pattern], strict=True))
    means = {
        colour: float(np.mean([phase.mean() for at, phase in phases.items() if colours[at] == colour]))
        for colour in "RGB"
    }
    most_mean = max(means.values())
    balanced, ceiling, most = mosaic.astype(np.float64), np.inf, mosaic.max(initial=0)
    for at, colour in colours.items():
        factor = most_mean / means[colour] if means[colour] > 0.0 else 1.0
        balanced[at[0] :: 2, at[1] :: 2] *= factor
        if np.count_nonzero(phases[at] == most) > _BURNT_SHARE * phases[at].size:
            ceiling = min(ceiling, factor * float(most))
    balanced = np.minimum(balanced, min(ceiling, np.iinfo(mosaic.dtype).max))
    return np.asarray(np.round(balanced).astype(mosaic.dtype))


def _unpacked(path: Path, data: np.ndarray, raw: RawFormat) -> np.ndarray:
    """Return the pixels of a file without a header."""
    if raw.size is None:
        raise InputError(
            f"{path} has no header, so its size is not known. State it with the pixel format, as in "
            "`raw='Mono12p:1280x1024'`."
        )
    width, height = raw.size
    count = width * height
    wanted = count if raw.bits == _WHOLE_BYTE else 2 * count
    if raw.packing == "p":
        wanted = (count * raw.bits + 7) // 8
    elif raw.packing == "Packed":
        wanted = (count + 1) // 2 * 3
    if len(data) != wanted:
        raise InputError(
            f"{path} has {len(data)} bytes, but {width} x {height} pixels of {raw.bits} bits take {wanted}. "
            "Check the size and the pixel format, and whether the file has a header that is to be cut off."
        )
    if raw.packing == "p":
        bits = np.unpackbits(data, bitorder="little")[: count * raw.bits].reshape(count, raw.bits)
        values = bits.astype(np.uint16) @ (1 << np.arange(raw.bits)).astype(np.uint16)
    elif raw.packing == "Packed":
        first, both, second = data.reshape(-1, 3).astype(np.uint16).T
        low = raw.bits - _WHOLE_BYTE
        mask = (1 << low) - 1
        values = np.stack([first << low | both & mask, second << low | both >> 4 & mask], axis=-1).ravel()[
            :count
        ]
    else:
        values = data if raw.bits == _WHOLE_BYTE else data.view("<u2")
    return np.ascontiguousarray(values.reshape(height, width)).astype(
        np.uint8 if raw.bits == _WHOLE_BYTE else np.uint16
    )
