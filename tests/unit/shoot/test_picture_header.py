from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from labcal.errors import InputError
from labcal.shoot.picture_header import PictureKind, declared_size, picture_kind, require_sensible_size

PICTURE = Image.fromarray(np.random.default_rng(0).integers(0, 256, (41, 67, 3), dtype=np.uint8))


def saved(form: str, **options: object) -> bytes:
    file = BytesIO()
    PICTURE.save(file, form, **options)
    return file.getvalue()


FILES = {
    "png": saved("png"),
    "jpeg": saved("jpeg"),
    "progressive jpeg": saved("jpeg", progressive=True, comment=b"a" * 3000),
    "tiff": saved("tiff"),
    "packed tiff": saved("tiff", compression="tiff_lzw"),
    "big tiff": saved("tiff", big_tiff=True),
    "bmp": saved("bmp"),
    "portable": saved("ppm"),
    "webp": saved("webp", quality=80),
    "webp without loss": saved("webp", lossless=True),
    "webp with metadata": saved("webp", icc_profile=b"a" * 100),
}


@pytest.mark.parametrize("name", FILES)
def test_the_declared_size_is_that_of_the_picture(name: str) -> None:
    assert picture_kind(FILES[name]) is not None
    assert declared_size(FILES[name]) == (67, 41)


@pytest.mark.parametrize("name", FILES)
def test_a_file_that_ends_in_its_header_declares_nothing(name: str) -> None:
    data = FILES[name]
    # A TIFF's directory may stand behind the picture.
    for length in range(8 if name == "portable" else 20):
        assert declared_size(data[:length]) is None


def test_big_endian_tiff() -> None:
    entries = [(256, 3, 67), (257, 3, 41)]
    data = b"MM\0*" + (8).to_bytes(4, "big") + len(entries).to_bytes(2, "big")
    for tag, kind, value in entries:
        data += tag.to_bytes(2, "big") + kind.to_bytes(2, "big") + (1).to_bytes(4, "big")
        data += value.to_bytes(2, "big") + b"\0\0"
    assert declared_size(data) == (67, 41)


def test_other_formats_are_none() -> None:
    assert picture_kind(saved("gif")) is None
    assert picture_kind(b"") is None
    assert picture_kind(b"\x76\x2f\x31\x01") is PictureKind.EXR
    assert declared_size(b"\x76\x2f\x31\x01" + bytes(100)) is None


@pytest.mark.parametrize(
    ("size", "length", "words"),
    [
        (None, 100, "does not state its size"),
        ((0, 50), 100, "0 x 50"),
        ((20_000, 20_000), 10**9, "more than"),
        ((5_000, 4_000), 10_000, "fill the memory"),
    ],
)
def test_sizes_that_make_no_sense_are_refused(size: tuple[int, int] | None, length: int, words: str) -> None:
    with pytest.raises(InputError, match=words):
        require_sensible_size(Path("a.png"), size, length)


def test_pictures_of_large_cameras_are_not_refused() -> None:
    require_sensible_size(Path("a.jpg"), (9_504, 6_336), 20_000_000)
    require_sensible_size(Path("dark.png"), (2_500, 2_000), 5_000)
