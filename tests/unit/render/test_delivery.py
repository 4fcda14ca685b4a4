from pathlib import Path

import numpy as np
import pytest

from labcal.render.delivery import Destination, deliver
from labcal.render.development import develop
from labcal.render.sensor_response import Exposure, Shot, expose, read_sensor
from labcal.scene.photometry import Photometry
from labcal.shoot.exr import read_exr_texts
from labcal.shoot.pictures import read_picture

EXPOSURE, SHOT = Exposure(0.9, (1.2, 1.0, 1.1)), Shot(4, "view", "left")
LIGHT = np.random.default_rng(2).random((70, 44, 3), dtype=np.float32)


def delivered(tmp_path: Path, photometry: Photometry) -> np.ndarray:
    """Deliver a picture twice, see that the bytes are the same, and read it."""
    light = LIGHT if photometry.bayer else LIGHT[..., 1]
    first, again = (tmp_path / f"{name}.{photometry.format}" for name in ("first", "again"))
    for path in (first, again):
        deliver(light, photometry, EXPOSURE, SHOT, Destination(path, {"labcal:note": "ä"}))
    assert first.read_bytes() == again.read_bytes()
    return read_picture(first)


@pytest.mark.parametrize("bayer", [True, False])
@pytest.mark.parametrize(("ending", "bits"), [("png", 8), ("png", 16), ("tif", 8), ("tif", 16)])
def test_what_is_developed_is_delivered_to_the_bit(
    tmp_path: Path,
    ending: str,
    bits: int,
    bayer: bool,  # noqa: FBT001
) -> None:
    photometry = Photometry(bayer=bayer, format=ending, bits=bits, prnu=0.01, dsnu_e=3.0)
    picture = delivered(tmp_path, photometry)
    light = LIGHT if bayer else LIGHT[..., 1]
    expected = develop(read_sensor(light, photometry, EXPOSURE, SHOT), photometry, EXPOSURE)
    assert picture.dtype == expected.dtype
    np.testing.assert_array_equal(picture, expected)


@pytest.mark.parametrize("ending", ["png", "tif"])
def test_a_raw_picture_holds_the_converters_codes(tmp_path: Path, ending: str) -> None:
    photometry = Photometry(bayer=True, format=ending, stage="raw", adc_bits=10)
    codes = delivered(tmp_path, photometry)
    assert codes.dtype == np.uint16
    assert 700 < codes.max() < 1023
    np.testing.assert_array_equal(codes, read_sensor(LIGHT, photometry, EXPOSURE, SHOT))


@pytest.mark.parametrize("bayer", [True, False])
def test_an_exr_holds_linear_light_without_noise_and_its_texts(tmp_path: Path, bayer: bool) -> None:  # noqa: FBT001
    photometry = Photometry(bayer=bayer, format="exr", prnu=0.1)
    picture = delivered(tmp_path, photometry)
    assert picture.dtype == np.float32
    np.testing.assert_array_equal(picture, expose(LIGHT if bayer else LIGHT[..., 1], EXPOSURE))
    assert read_exr_texts(tmp_path / "first.exr") == {"labcal:note": "ä"}


def test_a_jpeg_of_higher_quality_is_nearer_to_what_was_developed(tmp_path: Path) -> None:
    errors = []
    for quality in (60, 98):
        (tmp_path / str(quality)).mkdir()
        photometry = Photometry(jpeg_quality=quality)
        picture = delivered(tmp_path / str(quality), photometry)
        expected = develop(read_sensor(LIGHT[..., 1], photometry, EXPOSURE, SHOT), photometry, EXPOSURE)
        errors.append(np.abs(picture.astype(float) - expected).mean())
    assert errors[1] < 2.0 < errors[0]
