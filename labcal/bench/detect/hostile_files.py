"""Damaged and hostile picture files, drawn from a seed: the worst that a folder of pictures may hold."""

import os
import struct
import zlib
from collections.abc import Callable
from io import BytesIO
from pathlib import Path

import cv2
import numpy as np
from PIL import Image

from labcal.bench.detect.hostile_encoding import dots_picture, encoded, noisy_picture, zeros_png
from labcal.rng import generator

ENDINGS = (".png", ".jpg", ".tif", ".bmp", ".exr")
SIDES = (1, 2, 3, 5, 17, 1000)
"""Of pictures without room for anything."""
HUGE = (20_000, 32_767, 65_500, 100_000, 2**31 - 1)
BOMBS = ((12_000, 12_000), (11_000, 12_000), (40_000, 3_000), (5_000, 5_000), (2_800, 2_800), (60_000_000, 1))
"""Sizes of pictures that are all zeros and a few kilobytes long."""
STUFFED = ((8_000, 8_000), (5_000, 4_000))
"""Sizes of such pictures that carry a load, so that they do not look tightly packed."""
STUFFING = 200_000

Random = np.random.Generator
Made = tuple[str, bytes]
"""Ending and content of a file."""


def hostile_file(number: int, seed: int, folder: Path) -> Path:
    """Write one input and return its path; a few are folders, pipes or links to nowhere.

    Parameters
    ----------
    number : int
        Kinds follow each other in turn.
    seed : int
    folder : Path
        Where it goes.
    """
    random = generator(seed, "bench detect", "hostile", str(number))
    kind = list(KINDS)[number % len(KINDS)]
    made = KINDS[kind](random)
    path = folder / f"{number:05d}-{kind}{made[0]}"
    if kind == "no file":
        _no_file(path, int(random.integers(3)))
    else:
        path.write_bytes(made[1])
    return path


def _no_file(path: Path, which: int) -> None:
    """Make an entry with the name of a picture that is no file."""
    if which == 0:
        path.mkdir()
    elif which == 1 and hasattr(os, "mkfifo"):
        os.mkfifo(path)
    else:
        path.symlink_to(path.with_name("nowhere.png"))


def _whole(random: Random) -> Made:
    """Return an undamaged picture of the target."""
    ending = _ending(random)
    return ending, encoded(noisy_picture(random), ending)


def _ending(random: Random) -> str:
    """Draw an ending."""
    return str(random.choice(ENDINGS))


def _truncated(random: Random) -> Made:
    """Cut a file off."""
    ending, data = _whole(random)
    return ending, data[: int(random.uniform() ** 2 * len(data))]


def _bits_flipped(random: Random) -> Made:
    """Flip one to a hundred bits, often near the beginning."""
    ending, data = _whole(random)
    damaged = bytearray(data)
    reach = len(damaged) if random.uniform() < 0.5 else min(len(damaged), 200)  # noqa: PLR2004 -- one half
    for at in random.integers(0, reach, int(10 ** random.uniform(0.0, 2.0))).tolist():
        damaged[at] ^= 1 << int(random.integers(8))
    return ending, bytes(damaged)


def _overwritten(random: Random) -> Made:
    """Overwrite a part with noise or zeros, or remove it."""
    ending, data = _whole(random)
    first, last = sorted(random.integers(0, len(data), 2).tolist())
    middle = (random.bytes(last - first), bytes(last - first), b"")[int(random.integers(3))]
    return ending, data[:first] + middle + data[last:]


def _tiny(random: Random) -> Made:
    """Return a picture without room for anything."""
    ending = _ending(random)
    height, width = (int(random.choice(SIDES)) for _ in range(2))
    return ending, encoded(random.integers(0, 256, (height, width), dtype=np.uint8), ending)


def _empty_scene(random: Random) -> Made:
    """Return black, white, grey or one dot."""
    ending = _ending(random)
    picture = np.full(dots_picture().shape, int(random.choice([0, 128, 255])), dtype=np.uint8)
    if random.uniform() < 0.3:  # noqa: PLR2004 -- some of them
        cv2.circle(picture, (90, 70), int(random.integers(1, 60)), int(random.integers(256)), -1)
    return ending, encoded(picture, ending)


def _noise(random: Random) -> Made:
    """Return noise, fine or coarse, grey or in colour."""
    ending = str(random.choice([".png", ".bmp", ".tif"]))
    cell, height, width = (int(n) for n in (random.choice([1, 2, 4, 9]), *random.integers(100, 700, 2)))
    shape = (height, width, 3) if random.uniform() < 0.5 else (height, width)  # noqa: PLR2004 -- one half
    coarse = random.integers(0, 256, (height // cell + 1, width // cell + 1, *shape[2:]), dtype=np.uint8)
    return ending, encoded(coarse.repeat(cell, axis=0).repeat(cell, axis=1)[:height, :width], ending)


def _deep(random: Random) -> Made:
    """Return 16 bits, floats or signed values, also values that are no numbers."""
    grey = noisy_picture(random)
    values: list[tuple[str, np.ndarray]] = [
        (".png", grey.astype(np.uint16) * 257),
        (".tif", grey.astype(np.uint16) * 17),
        (".tif", grey.astype(np.float32) / 255),
        (".tif", np.where(grey > 200, np.nan, grey).astype(np.float32)),  # noqa: PLR2004 -- the board
        (".tif", np.where(grey > 200, np.inf, grey).astype(np.float64)),  # noqa: PLR2004 -- the board
        (".tif", grey.astype(np.int16) - 128),
        (".tif", grey.astype(np.int32)),
        (".exr", np.where(grey > 200, np.nan, grey)),  # noqa: PLR2004 -- the board
    ]
    ending, picture = values[int(random.integers(len(values)))]
    return ending, encoded(picture, ending)


def _by_pillow(random: Random) -> Made:
    """Return palettes, alpha, CMYK, single bits, orientations, several pictures in one file, animations."""
    grey = Image.fromarray(noisy_picture(random))
    turned = Image.Exif()
    turned[0x0112] = int(random.integers(1, 9))
    more = [Image.fromarray(noisy_picture(random)) for _ in range(2)]
    forms: list[tuple[str, Callable[[BytesIO], None]]] = [
        (".png", lambda file: grey.convert("RGBA").save(file, "png")),
        (".png", lambda file: grey.convert("LA").save(file, "png")),
        (".png", lambda file: grey.convert("P").save(file, "png")),
        (".png", lambda file: grey.convert("1").save(file, "png")),
        (".png", lambda file: grey.save(file, "png", save_all=True, append_images=more)),
        (".png", lambda file: grey.save(file, "png", exif=turned)),
        (".png", lambda file: grey.save(file, "webp", save_all=True, append_images=more)),
        (".gif", lambda file: grey.save(file, "gif", save_all=True, append_images=more)),
        (
            ".tif",
            lambda file: grey.save(file, "tiff", save_all=True, append_images=more, compression="tiff_lzw"),
        ),
        (".tif", lambda file: grey.convert("CMYK").save(file, "tiff")),
        (".jpg", lambda file: grey.convert("CMYK").save(file, "jpeg")),
        (".jpg", lambda file: grey.save(file, "jpeg", exif=turned)),
        (".jpg", lambda file: grey.save(file, "jpeg", progressive=True, quality=int(random.integers(1, 96)))),
        (".webp", lambda file: grey.save(file, "webp")),
    ]
    ending, save = forms[int(random.integers(len(forms)))]
    file = BytesIO()
    save(file)
    return ending, file.getvalue()


def _size_patched(random: Random) -> Made:
    """Let the header of a small file declare a huge picture."""
    ending, data = _whole(random)
    width, height = (int(random.choice(HUGE)) for _ in range(2))
    old = struct.pack(">II", *dots_picture().shape[::-1])
    damaged = bytearray(data)
    if ending == ".png":
        damaged[16:24] = struct.pack(">II", width, height)
        damaged[29:33] = struct.pack(">I", zlib.crc32(damaged[12:29]))
    elif ending == ".jpg":
        at = data.find(old[6:] + old[2:4])  # two bytes each, the height first
        damaged[at : at + 4] = struct.pack(">HH", min(height, 65_500), min(width, 65_500))
    elif ending == ".bmp":
        damaged[18:26] = struct.pack("<ii", width, height)
    else:  # TIFF's and OpenEXR's sizes are somewhere in the file, in little endian
        for side, new in zip(dots_picture().shape[::-1], (width, height), strict=True):
            for form, less in (("<I", 0), ("<H", 0), ("<I", 1)):
                before = struct.pack(form, side - less)
                after = struct.pack(form, min(new, 65_535 if form == "<H" else new) - less)
                damaged = bytearray(bytes(damaged).replace(before, after, 1))
    return ending, bytes(damaged)


def _bombs(random: Random) -> Made:
    """Return a small file that expands to a large one."""
    which = int(random.integers(len(BOMBS) + len(STUFFED)))
    return ".png", zeros_png((*BOMBS, *STUFFED)[which], STUFFING if which >= len(BOMBS) else 0)


def _no_picture(random: Random) -> Made:
    """Return text, another format, or noise, named as a picture; or nothing."""
    contents = [
        b"",
        b"This is text.\n" * int(random.integers(1, 500)),
        b"P5 99999 99999 255\n" + random.bytes(200),
        b"<svg xmlns='http://www.w3.org/2000/svg' width='99999' height='99999'/>",
        b"PK\x03\x04" + random.bytes(300),
        b"\x89PNG\r\n\x1a\n" + random.bytes(300),
        b"\xff\xd8\xff\xe0" + random.bytes(300) + b"\xff\xd9",
        b"II*\0" + random.bytes(300),
        b"BM" + random.bytes(300),
        b"\x76\x2f\x31\x01" + random.bytes(300),
        random.bytes(int(random.integers(1, 5000))),
        encoded(noisy_picture(random), _ending(random)),
    ]
    return _ending(random), contents[int(random.integers(len(contents)))]


KINDS: dict[str, Callable[[Random], Made]] = {
    "truncated": _truncated,
    "bits flipped": _bits_flipped,
    "overwritten": _overwritten,
    "tiny": _tiny,
    "empty scene": _empty_scene,
    "noise": _noise,
    "deep": _deep,
    "unusual": _by_pillow,
    "size patched": _size_patched,
    "bomb": _bombs,
    "no picture": _no_picture,
    "no file": lambda random: (_ending(random), b""),
    "whole": _whole,
}
"""Kinds of inputs by name, each drawn in turn."""
