import tracemalloc

import numpy as np
import pytest

from labcal.render import bands
from labcal.render.demosaic import demosaic
from labcal.render.development import develop
from labcal.render.sensor_response import Exposure, Shot, exposure_for, read_sensor
from labcal.scene.photometry import Photometry
from labcal.shoot.tone_curve import ToneCurve

UNIT = Exposure(1.0, (1.0, 1.0, 1.0))


@pytest.mark.parametrize("bits", [8, 16])
def test_a_board_under_coloured_light_comes_out_grey_at_the_level_asked_for(bits: int) -> None:
    photometry = Photometry(
        bayer=True, white=0.5, tone_curve=ToneCurve.LINEAR, adc_bits=16, bits=bits, format="png",
        black_level_dn=900.0,
    )  # fmt: skip
    radiance = np.array([0.3, 0.5, 0.4])
    exposure = exposure_for(photometry, radiance)
    light = np.broadcast_to(radiance, (140, 50, 3)).astype(np.float32)
    picture = develop(read_sensor(light, photometry, exposure, None), photometry, exposure)
    assert picture.shape == (140, 50, 3)
    assert picture.dtype == (np.uint8 if bits == 8 else np.uint16)
    assert np.abs(picture - 0.5 * (2**bits - 1)).max() <= 1.0


def test_codes_below_black_are_black_and_saturated_ones_white_whatever_the_balance() -> None:
    photometry = Photometry(bayer=True, adc_bits=10, black_level_dn=50.0)
    exposure = Exposure(1.0, (1.4, 1.0, 1.2))
    assert develop(np.full((8, 8), 30, np.uint16), photometry, exposure).max() == 0
    assert develop(np.full((8, 8), 1023, np.uint16), photometry, exposure).min() == 255


def test_grey_codes_are_spread_over_all_levels() -> None:
    photometry = Photometry(adc_bits=16, bits=16, format="png", tone_curve=ToneCurve.LINEAR)
    codes = np.arange(65536, dtype=np.uint16).reshape(256, 256)
    np.testing.assert_array_equal(develop(codes, photometry, UNIT), codes)


def test_a_higher_gain_saturates_with_fewer_electrons() -> None:
    photometry = Photometry(
        adc_bits=12, full_well_e=20000.0, gain_dn_per_e=0.5, white=0.5, tone_curve="linear"
    )
    exposure = exposure_for(photometry, np.ones(3))
    codes = read_sensor(np.ones((4, 4), np.float32), photometry, exposure, None)
    assert (codes == round(0.5 * 4095)).all()
    assert (develop(codes, photometry, exposure) == 128).all()


def test_bands_leave_no_seams(monkeypatch: pytest.MonkeyPatch) -> None:
    codes = np.random.default_rng(0).integers(0, 4096, (151, 40), dtype=np.uint16)
    photometry, exposure = Photometry(bayer=True), Exposure(1.0, (1.3, 1.0, 1.1))
    banded = develop(codes, photometry, exposure)
    monkeypatch.setattr(bands, "ROWS", 1000)
    np.testing.assert_array_equal(banded, develop(codes, photometry, exposure))


def test_the_balance_is_made_before_the_colours() -> None:
    codes = np.random.default_rng(0).integers(500, 1500, (20, 30), dtype=np.uint16)
    photometry = Photometry(bayer=True, tone_curve=ToneCurve.LINEAR, bits=16, format="png")
    factors = np.ones((20, 30))
    factors[0::2, 0::2], factors[1::2, 1::2] = 1.3, 1.1
    expected = np.clip(demosaic(codes / 4095.0 * factors), 0.0, 1.0)
    picture = develop(codes, photometry, Exposure(1.0, (1.3, 1.0, 1.1)))
    np.testing.assert_allclose(picture / 65535.0, expected, atol=1e-5)


def test_memory_beside_the_results_does_not_grow_with_the_picture() -> None:
    photometry = Photometry(bayer=True, prnu=0.01, dsnu_e=2.0)
    beside = []
    for height in (128, 1024):
        light = np.full((height, 256, 3), 0.5, np.float32)
        tracemalloc.start()
        codes = read_sensor(light, photometry, UNIT, Shot(1, "a", "b"))
        picture = develop(codes, photometry, UNIT)
        beside.append(tracemalloc.get_traced_memory()[1] - codes.nbytes - picture.nbytes)
        tracemalloc.stop()
    assert beside[1] < 1.2 * beside[0]
    assert beside[1] < 1024 * 256 * 3 * 4  # less than the light itself, which copies would take
