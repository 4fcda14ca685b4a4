"""Files with several pictures are refused, and portable pictures in words are read."""

import struct
import zlib
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.errors import InputError
from labcal.shoot.picture_stacks import require_one_picture
from labcal.shoot.pictures import read_picture

GREY = np.arange(12, dtype=np.uint8).reshape(3, 4) * 20


def tiff(pages: list[tuple[np.ndarray, int]], order: str = "<") -> bytes:
    """Return a TIFF of uncompressed grey pictures, each with its NewSubfileType."""
    data = {"<": b"II*\0", ">": b"MM\0*"}[order] + struct.pack(order + "I", 8)
    for number, (page, subfile) in enumerate(pages):
        tags = [(254, 4, subfile), (256, 4, page.shape[1]), (257, 4, page.shape[0]), (258, 4, 8), (259, 4, 1),
                (262, 4, 1), (273, 4, len(data) + 2 + 10 * 12 + 4), (277, 4, 1), (278, 4, page.shape[0]),
                (279, 4, page.size)]  # fmt: skip
        end = len(data) + 2 + 12 * len(tags) + 4 + page.size
        data += struct.pack(order + "H", len(tags))
        data += b"".join(struct.pack(order + "HHII", tag, kind, 1, value) for tag, kind, value in tags)
        data += struct.pack(order + "I", end if number + 1 < len(pages) else 0) + page.tobytes()
    return data


@pytest.mark.parametrize("order", ["<", ">"])
def test_a_stack_is_refused_with_its_count(order: str, tmp_path: Path) -> None:
    path = tmp_path / "stack.tif"
    path.write_bytes(tiff([(GREY, 0), (GREY + 1, 0), (GREY + 2, 0)], order))
    with pytest.raises(InputError, match=r"holds 3 pictures.*Split it"):
        read_picture(path)


@pytest.mark.parametrize("second", [(GREY[:2, :2].copy(), 0), (GREY, 1), (GREY, 4)])
def test_a_thumbnail_is_no_second_picture(second: tuple[np.ndarray, int], tmp_path: Path) -> None:
    path = tmp_path / "photograph.tif"
    path.write_bytes(tiff([(GREY, 0), second]))
    np.testing.assert_array_equal(read_picture(path), GREY)


def test_an_animation_is_refused(tmp_path: Path) -> None:
    path = tmp_path / "moving.png"
    whole = cv2.imencode(".png", GREY)[1].tobytes()
    chunk = b"acTL" + struct.pack(">II", 7, 0)
    path.write_bytes(
        whole[:33] + struct.pack(">I", 8) + chunk + struct.pack(">I", zlib.crc32(chunk)) + whole[33:]
    )
    with pytest.raises(InputError, match="holds 7 pictures"):
        read_picture(path)
    frames = (b"ANMF" + struct.pack("<I", 3) + bytes(4)) * 2
    webp = b"RIFF" + bytes(4) + b"WEBPVP8X" + struct.pack("<IB", 10, 2) + bytes(9) + frames
    with pytest.raises(InputError, match="holds 2 pictures"):
        require_one_picture(Path("moving.webp"), webp)


def test_directories_that_lead_back_to_themselves_end() -> None:
    data = bytearray(tiff([(GREY, 0)]))
    data[8 + 2 + 120 : 8 + 2 + 124] = struct.pack("<I", 8)
    require_one_picture(Path("loop.tif"), bytes(data))


@pytest.mark.parametrize("end", ["", "\n"])
def test_a_portable_picture_in_words(end: str, tmp_path: Path) -> None:
    path = tmp_path / "a.pgm"
    path.write_text("P2\n# a comment\n4 3\n255\n" + " ".join(map(str, GREY.ravel())) + end)
    np.testing.assert_array_equal(read_picture(path), GREY)
