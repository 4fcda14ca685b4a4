"""The picture from which hostile inputs are made, and picture files as bytes."""

import struct
import zlib
from functools import cache
from pathlib import Path
from tempfile import TemporaryDirectory

import cv2
import numpy as np

from labcal.shoot.exr import write_exr
from labcal.targets.grid import DotGrid, Rings

RING_HOLE_MM = 2.2
TARGET = DotGrid(
    name="hostile",
    cols=6,
    rows=5,
    pitch_x_mm=10.0,
    pitch_y_mm=10.0,
    dot_diameter_mm=5.0,
    ring_outer_diameter_mm=5.0,
    ring_inner_diameter_mm=RING_HOLE_MM,
    rings=Rings(origin=(1, 1), x=(4, 1), y=(1, 3)),
    margin_mm=10.0,
)
"""The target in the undamaged pictures."""
PX_PER_MM = 3.0


@cache
def dots_picture() -> np.ndarray:
    """Draw the target, uint8."""
    x_min, y_min, x_max, y_max = TARGET.extent_mm
    picture = np.full((int((y_max - y_min) * PX_PER_MM), int((x_max - x_min) * PX_PER_MM)), 210, np.uint8)
    for index, point in zip(TARGET.indices().tolist(), TARGET.points(), strict=True):
        x, y = (PX_PER_MM * (point[:2] - [x_min, y_min]) * 16).astype(int).tolist()
        y = 16 * picture.shape[0] - y
        radii = [(0.5 * TARGET.dot_diameter_mm, 40)]
        if tuple(index) in TARGET.ring_indices:
            radii.append((0.5 * RING_HOLE_MM, 210))
        for radius, grey in radii:
            cv2.circle(picture, (x, y), round(16 * PX_PER_MM * radius), grey, -1, cv2.LINE_AA, 4)
    return picture


def noisy_picture(random: np.random.Generator) -> np.ndarray:
    """Return the target with noise."""
    noise = random.normal(0.0, 3.0, dots_picture().shape)
    return np.clip(dots_picture() + noise, 0, 255).astype(np.uint8)


def encoded(picture: np.ndarray, ending: str) -> bytes:
    """Return a file of a picture; OpenEXR holds it as floats."""
    if ending == ".exr":
        return _exr(np.ascontiguousarray(picture, dtype=np.float32))
    return bytes(cv2.imencode(ending, picture)[1])


def _exr(picture: np.ndarray) -> bytes:
    """Return an OpenEXR file; the library writes to paths only."""
    with TemporaryDirectory() as home:
        write_exr(Path(home) / "a.exr", picture, {})
        return (Path(home) / "a.exr").read_bytes()


@cache
def zeros_png(size: tuple[int, int], load: int) -> bytes:
    """Return a PNG file of zeros with a payload of some bytes."""
    width, height = size
    header = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    packed = zlib.compress(bytes((width + 1) * height))
    parts = [b"\x89PNG\r\n\x1a\n"]
    for name, content in ((b"IHDR", header), (b"loAd", bytes(load)), (b"IDAT", packed), (b"IEND", b"")):
        check = zlib.crc32(name + content)
        parts.append(struct.pack(">I", len(content)) + name + content + struct.pack(">I", check))
    return b"".join(parts)
