from pathlib import Path

import numpy as np
import OpenEXR
import pytest

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
@pytest.mark.parametrize("ending", ["png", "jpg", "tif", "bmp"])
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
    with pytest.raises(OutputError, match="--force"):
        write_picture(tmp_path / "a.png", GREY)
    write_picture(tmp_path / "a.png", COLOUR, force=True)
    with pytest.raises(OutputError, match=r"ends in \.png, \.jpg or \.tif"):
        write_picture(tmp_path / "a.pmg", GREY)
    assert [path.name for path in tmp_path.iterdir()] == ["a.png"]
