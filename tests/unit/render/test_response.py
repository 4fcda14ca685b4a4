import cv2
import numpy as np
import pytest
from scipy.stats import chi2

from labcal.render.demosaic import demosaic, mosaic
from labcal.render.response import develop, expose, exposure_for, read_sensor, tone
from labcal.rng import generator
from labcal.scene.photometry import Photometry, ToneCurve

FLAT = (200, 300)
PHOTOMETRY = Photometry(full_well_e=6000.0, read_noise_e=8.0, adc_bits=16, blur_px=0.0)


@pytest.mark.parametrize("share", [0.05, 0.75])
def test_noise_has_the_variance_of_photons_and_reading(share: float) -> None:
    reading = read_sensor(np.full(FLAT, share), PHOTOMETRY, generator(7, "flat", str(share)))
    electrons = reading * PHOTOMETRY.full_well_e
    expected = share * PHOTOMETRY.full_well_e + PHOTOMETRY.read_noise_e**2
    n = electrons.size
    low, high = chi2.ppf([5e-4, 1 - 5e-4], n - 1)
    assert low < (n - 1) * electrons.var(ddof=1) / expected < high
    z = (electrons.mean() - share * PHOTOMETRY.full_well_e) / np.sqrt(expected / n)
    assert abs(z) < 3.3


def test_without_noise_the_converter_rounds_and_full_scale_is_its_highest_code() -> None:
    photometry = PHOTOMETRY.model_copy(update={"adc_bits": 10})
    share = np.array([[0.0, 0.25, 0.5, 1.0, 1.7]])
    np.testing.assert_array_equal(
        read_sensor(share, photometry, None) * 1023, np.array([[0.0, 256.0, 512.0, 1023.0, 1023.0]])
    )


def test_the_tone_curve_is_that_of_iec_61966() -> None:
    linear = np.array([0.0, 0.002, 0.0031308, 0.18, 1.0])
    expected = [0.0, 0.02584, 0.040450, 0.461356, 1.0]
    np.testing.assert_allclose(tone(linear, ToneCurve.SRGB), expected, atol=2e-6)
    np.testing.assert_array_equal(tone(linear, ToneCurve.LINEAR), linear)


def test_a_board_under_coloured_light_comes_out_grey_at_the_level_asked_for() -> None:
    photometry = Photometry(bayer=True, white=0.5, tone_curve=ToneCurve.LINEAR, adc_bits=16)
    radiance = np.array([0.3, 0.5, 0.4])
    exposure = exposure_for(photometry, radiance)
    light = np.broadcast_to(radiance, (40, 50, 3)).astype(np.float32)
    share = expose(light, photometry, exposure)
    assert share.max() == pytest.approx(0.5, rel=1e-6)  # green, the strongest
    picture = develop(share, photometry, exposure, None)
    assert picture.shape == (40, 50, 3)
    assert set(np.unique(picture)) <= {127, 128}


def test_the_point_spread_keeps_a_dots_centroid_and_light() -> None:
    light = np.zeros((41, 41), np.float32)
    light[17:22, 19:26] = 1.0
    photometry = Photometry(blur_px=0.8)
    share = expose(light, photometry, exposure_for(photometry, np.ones(3) * photometry.white))
    assert share.sum() == pytest.approx(light.sum(), rel=1e-5)
    y, x = np.mgrid[:41, :41]
    assert (x * share).sum() / share.sum() == pytest.approx(22.0, abs=1e-4)
    assert (y * share).sum() / share.sum() == pytest.approx(19.0, abs=1e-4)
    assert share.max() < 1.0


def test_demosaicing_is_exact_on_grey_ramps() -> None:
    # All three colours equal and linear in position: the filters are exact there, away from the border.
    y, x = np.mgrid[:24, :30].astype(np.float64)
    grey = 0.2 + 0.01 * x + 0.015 * y
    picture = demosaic(mosaic(np.stack([grey] * 3, axis=-1)))
    np.testing.assert_allclose(picture[2:-2, 2:-2], np.stack([grey] * 3, axis=-1)[2:-2, 2:-2], atol=1e-6)


def test_demosaicing_puts_each_colour_where_opencv_does() -> None:
    y, x = np.mgrid[:40, :40]
    smooth = np.stack([20000 + 8000 * np.sin((x + 2 * y + k) / 9 + k) for k in range(3)], axis=-1)
    ours = demosaic(mosaic(smooth))
    # OpenCV names the pattern by the second row's second and third pixels.
    theirs = cv2.demosaicing(mosaic(smooth).astype(np.uint16), cv2.COLOR_BayerBG2RGB)
    inside = (slice(3, -3), slice(3, -3))
    assert np.abs(ours[inside] - smooth[inside]).max() < 600
    assert np.abs(theirs[inside] - smooth[inside]).max() < 400


def test_a_mosaic_starts_with_red_green() -> None:
    behind = mosaic(np.broadcast_to(np.array([1.0, 2.0, 3.0]), (4, 4, 3)))
    np.testing.assert_array_equal(behind[:2, :2], [[1.0, 2.0], [2.0, 3.0]])
