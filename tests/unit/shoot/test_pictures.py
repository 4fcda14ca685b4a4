import os
import time
from pathlib import Path

import cv2
import numpy as np
import OpenEXR
import pytest
from PIL import Image

from labcal.errors import InputError, OutputError
from labcal.shoot.pictures import read_picture, write_picture

RNG = np.random.default_rng(1)
GREY = RNG.integers(0, 256, (40, 60), dtype=np.uint8)
COLOUR = RNG.integers(0, 256, (40, 60, 3), dtype=np.uint8)
DEEP = RNG.integers(0, 65536, (40, 60), dtype=np.uint16)
DEEP_COLOUR = RNG.integers(0, 65536, (40, 60, 3), dtype=np.uint16)


@pytest.mark.parametrize("ending", ["png", "tif", "tiff"])
@pytest.mark.parametrize(
    "picture", [GREY, COLOUR, DEEP, DEEP_COLOUR], ids=["grey", "colour", "16 bits", "colour in 16 bits"]
)
def test_lossless_pictures_read_back_exactly(tmp_path: Path, ending: str, picture: np.ndarray) -> None:
    write_picture(tmp_path / f"a.{ending}", picture)
    back = read_picture(tmp_path / f"a.{ending}")
    assert back.dtype == picture.dtype
    np.testing.assert_array_equal(back, picture)


@pytest.mark.parametrize(
    ("header", "depth", "picture"),
    [
        (b"P5\n60 40\n255\n", ">u1", GREY),
        (b"P5 # a camera wrote this\n# 12 34\n60 40\n4095\n", ">u2", DEEP % 4096),
        (b"P6\n60\t40 65535\n", ">u2", DEEP_COLOUR),
        (b"P6\n60 40\n255\n", ">u1", COLOUR),
    ],
    ids=["grey", "12 bits, with comments", "colour in 16 bits", "colour"],
)
def test_portable_pictures_keep_their_values(
    tmp_path: Path, header: bytes, depth: str, picture: np.ndarray
) -> None:
    (tmp_path / "a.pgm").write_bytes(header + picture.astype(depth).tobytes())
    back = read_picture(tmp_path / "a.pgm")
    assert back.dtype == picture.dtype
    np.testing.assert_array_equal(back, picture)


def test_text_and_bits_are_portable_pictures_too(tmp_path: Path) -> None:
    words = "\n".join(" ".join(map(str, row)) for row in (DEEP % 1024).tolist())
    (tmp_path / "a.pgm").write_text(f"P2\n60 40\n1023\n{words}\n")
    np.testing.assert_array_equal(read_picture(tmp_path / "a.pgm"), DEEP % 1024)
    bits = GREY[:, :56] < 128
    (tmp_path / "a.pbm").write_bytes(b"P4\n56 40\n" + np.packbits(bits, axis=1).tobytes())
    np.testing.assert_array_equal(read_picture(tmp_path / "a.pbm"), np.where(bits, 0, 255))


def test_webp_without_loss_is_read_exactly(tmp_path: Path) -> None:
    Image.fromarray(COLOUR).save(tmp_path / "a.webp", lossless=True)
    np.testing.assert_array_equal(read_picture(tmp_path / "a.webp"), COLOUR)
    Image.fromarray(np.full((40, 60), 90, dtype=np.uint8)).save(tmp_path / "b.webp", quality=90)
    assert abs(read_picture(tmp_path / "b.webp").astype(float) - 90).max() <= 2


def test_12_bits_packed_in_a_tiff_keep_their_order_of_light(tmp_path: Path) -> None:
    """Two pixels in three bytes, the upper bits first, as TIFF 6.0 packs them; read in the range of 16."""
    values = (DEEP % 4096).ravel().astype(np.uint32)
    pairs = values.reshape(-1, 2)
    packed = np.stack(
        [pairs[:, 0] >> 4, (pairs[:, 0] & 15) << 4 | pairs[:, 1] >> 8, pairs[:, 1] & 255], axis=1
    )
    data = packed.astype(np.uint8).tobytes()
    tags = [
        (256, 60),
        (257, 40),
        (258, 12),
        (259, 1),
        (262, 1),
        (273, 8),
        (277, 1),
        (278, 40),
        (279, len(data)),
    ]
    directory = b"".join(
        tag.to_bytes(2, "little") + (4).to_bytes(2, "little") + (1).to_bytes(4, "little")
        + value.to_bytes(4, "little") for tag, value in tags
    )  # fmt: skip
    (tmp_path / "a.tif").write_bytes(
        b"II*\0" + (8 + len(data)).to_bytes(4, "little") + data + len(tags).to_bytes(2, "little") + directory
        + bytes(4)
    )  # fmt: skip
    np.testing.assert_array_equal(read_picture(tmp_path / "a.tif"), (DEEP % 4096) * 16)


def test_colours_keep_their_order_in_jpeg(tmp_path: Path) -> None:
    red = np.zeros((16, 16, 3), dtype=np.uint8)
    red[..., 0] = 200
    write_picture(tmp_path / "a.jpg", red, jpeg_quality=100)
    np.testing.assert_allclose(read_picture(tmp_path / "a.jpg").mean(axis=(0, 1)), [200, 0, 0], atol=3)


def test_exr_is_linear_float(tmp_path: Path) -> None:
    light = RNG.random((40, 60, 3), dtype=np.float32)
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"RGB": light}).write(str(tmp_path / "a.exr"))
    OpenEXR.File(header, {"Y": light[..., 0].copy()}).write(str(tmp_path / "y.exr"))
    np.testing.assert_array_equal(read_picture(tmp_path / "a.exr"), light)
    np.testing.assert_array_equal(read_picture(tmp_path / "y.exr"), light[..., 0])
    (tmp_path / "b.exr").write_bytes((tmp_path / "a.exr").read_bytes()[:3000])
    with pytest.raises(InputError, match=r"b\.exr is not an OpenEXR file that can be read"):
        read_picture(tmp_path / "b.exr")


@pytest.mark.parametrize("share", [0.0, 0.02, 0.5, 0.97])
@pytest.mark.parametrize("ending", ["png", "jpg", "tif", "bmp", "ppm", "webp"])
def test_a_truncated_picture_is_refused(tmp_path: Path, ending: str, share: float) -> None:
    path = tmp_path / f"a.{ending}"
    write_picture(path, COLOUR)
    data = path.read_bytes()
    path.write_bytes(data[: int(share * len(data))])
    with pytest.raises(InputError, match=rf"a\.{ending} is (truncated|not a picture).*Copy it again"):
        read_picture(path)


def test_what_is_no_picture_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.png").write_text("text")
    with pytest.raises(InputError, match="is not a picture"):
        read_picture(tmp_path / "a.png")
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_picture(tmp_path / "b.png")


def test_pictures_are_not_replaced_unasked_nor_written_in_unknown_forms(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", GREY)
    with pytest.raises(OutputError, match="`force=True`"):
        write_picture(tmp_path / "a.png", GREY)
    write_picture(tmp_path / "a.png", COLOUR, force=True)
    with pytest.raises(OutputError, match=r"ends in \.png, \.jpg or \.tif"):
        write_picture(tmp_path / "a.pmg", GREY)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]


def oriented(orientation: int) -> Image.Exif:
    exif = Image.Exif()
    exif[0x0112] = orientation
    return exif


@pytest.mark.parametrize("ending", ["jpg", "png"])
@pytest.mark.parametrize("orientation", [3, 6, 8])
def test_pixels_are_those_of_the_sensor_whatever_orientation_is_stated(
    tmp_path: Path, ending: str, orientation: int
) -> None:
    plain, turned = tmp_path / f"plain.{ending}", tmp_path / f"turned.{ending}"
    Image.fromarray(GREY).save(plain)
    Image.fromarray(GREY).save(turned, exif=oriented(orientation))
    assert plain.read_bytes() != turned.read_bytes()
    np.testing.assert_array_equal(read_picture(turned), read_picture(plain))
    assert read_picture(turned).shape == GREY.shape


def test_an_animation_is_refused_with_its_count(tmp_path: Path) -> None:
    first, *more = (Image.fromarray(picture) for picture in (GREY, 255 - GREY, GREY // 2))
    for ending in (".png", ".tif", ".webp"):
        first.save(tmp_path / f"a{ending}", save_all=True, append_images=more)
        with pytest.raises(InputError, match="holds 3 pictures"):
            read_picture(tmp_path / f"a{ending}")


def test_what_would_fill_the_memory_is_refused_before_it_is_decoded(tmp_path: Path) -> None:
    Image.fromarray(np.zeros((3000, 3000), dtype=np.uint8)).save(tmp_path / "packed.png")
    with pytest.raises(InputError, match=r"3000 x 3000 pixels in \d+ bytes"):
        read_picture(tmp_path / "packed.png")
    data = bytearray((tmp_path / "packed.png").read_bytes())
    data[16:24] = (100_000).to_bytes(4, "big") * 2
    (tmp_path / "patched.png").write_bytes(data)
    with pytest.raises(InputError, match=r"100000 x 100000 pixels, more than"):
        read_picture(tmp_path / "patched.png")
    # Of one colour and not large: a lens cap makes such pictures.
    Image.fromarray(np.zeros((1000, 1000), dtype=np.uint8)).save(tmp_path / "black.png")
    assert read_picture(tmp_path / "black.png").shape == (1000, 1000)


def test_folders_and_pipes_are_no_pictures(tmp_path: Path) -> None:
    (tmp_path / "a.png").mkdir()
    os.mkfifo(tmp_path / "b.png")
    for name in ("a.png", "b.png"):
        with pytest.raises(InputError, match="it is no file"):
            read_picture(tmp_path / name)


def test_the_content_tells_the_format_and_not_the_name(tmp_path: Path) -> None:
    Image.fromarray(GREY).save(tmp_path / "a.bmp")
    (tmp_path / "a.bmp").rename(tmp_path / "a.png")
    np.testing.assert_array_equal(read_picture(tmp_path / "a.png"), GREY)
    Image.fromarray(GREY).save(tmp_path / "b.gif")
    with pytest.raises(InputError, match="none of PNG, JPEG, TIFF, BMP, PGM or PPM, WebP, OpenEXR"):
        read_picture(tmp_path / "b.gif")


def test_a_tiff_with_broken_strips_is_refused_at_once_and_in_silence(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """OpenCV leaves out the strips that it cannot decode, gives the rest, and prints a line for each."""
    grey = np.random.default_rng(0).integers(0, 255, (1500, 1000)).astype(np.uint8)
    options = [cv2.IMWRITE_TIFF_COMPRESSION, 5, cv2.IMWRITE_TIFF_ROWSPERSTRIP, 1]
    data = bytearray(cv2.imencode(".tif", grey, options)[1].tobytes())
    path = tmp_path / "a.tif"
    path.write_bytes(data)
    np.testing.assert_array_equal(read_picture(path), grey)
    for at in range(1000, len(data) - 100_000, 997):
        data[at] ^= 0xFF
    path.write_bytes(data)
    began = time.monotonic()
    with pytest.raises(InputError, match=r"is damaged \(.*\)\. Copy it again"):
        read_picture(path)
    assert time.monotonic() - began < 2.0
    assert capfd.readouterr().err == ""


@pytest.mark.parametrize(
    ("name", "data", "words"),
    [
        (
            "a.HEIC",
            b"\0\0\0\x18ftypheic" + bytes(99),
            "none of PNG, .*, which labcal reads.*Convert them to PNG",
        ),
        ("a.png", b"\0\0\0\x18ftypavif" + bytes(99), "Convert them to PNG"),
        ("a.gif", b"GIF89a" + bytes(99), "Convert them to PNG"),
        ("a.cr2", b"II*\0" + bytes(99), "Export raw pictures as TIFF of 16 bits"),
        ("a.raw", bytes(99), "state their format: `raw='Mono8:1280x1024'`"),
        ("a.mp4", b"\0\0\0\x18ftypmp42" + bytes(99), "It is a film"),
        ("a.png", b"", r"is empty \(0 bytes\)"),
    ],
)
def test_formats_that_are_not_read_are_named_with_what_to_do(
    tmp_path: Path, name: str, data: bytes, words: str
) -> None:
    (tmp_path / name).write_bytes(data)
    with pytest.raises(InputError, match=words):
        read_picture(tmp_path / name)


def test_the_preview_in_a_raw_picture_is_not_taken_for_the_picture(tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.tif"), np.zeros((8, 8), np.uint8))
    (tmp_path / "a.tif").rename(tmp_path / "a.dng")
    with pytest.raises(InputError, match="Export raw pictures"):
        read_picture(tmp_path / "a.dng")
