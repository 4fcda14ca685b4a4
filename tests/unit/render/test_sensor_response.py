import numpy as np
import pytest
from scipy.stats import chi2

from labcal.render import bands
from labcal.render.sensor_response import Exposure, Shot, expose, exposure_for, read_sensor
from labcal.scene.photometry import Photometry

FLAT = (200, 300)
PHOTOMETRY = Photometry(full_well_e=6000.0, read_noise_e=8.0, adc_bits=16, black_level_dn=2000.0, blur_px=0.0)
UNIT = Exposure(1.0, (1.0, 1.0, 1.0))


def electrons(share: float, photometry: Photometry, shot: Shot | None) -> np.ndarray:
    """Return the electrons that evenly lit pixels read."""
    codes = read_sensor(np.full(FLAT, share, np.float32), photometry, UNIT, shot)
    return (codes - photometry.black_level_dn) / photometry.gain


@pytest.mark.parametrize("share", [0.0, 0.005, 0.05, 0.75])
def test_noise_has_the_variance_of_photons_dark_current_patterns_and_reading(share: float) -> None:
    photometry = PHOTOMETRY.model_copy(
        update={"prnu": 0.01, "dsnu_e": 5.0, "dark_current_e_per_s": 3000.0, "exposure_ms": 20.0}
    )
    read = electrons(share, photometry, Shot(7, "flat", "left"))
    mean = share * 6000.0 + 60.0
    expected = mean + (0.01 * share * 6000.0) ** 2 + 5.0**2 + 8.0**2 + 1 / (12 * photometry.gain**2)
    n = read.size
    low, high = chi2.ppf([5e-4, 1 - 5e-4], n - 1)
    assert low < (n - 1) * read.var(ddof=1) / expected < high
    assert abs(read.mean() - mean) / np.sqrt(expected / n) < 3.3


def test_patterns_stay_with_the_camera_and_noise_does_not() -> None:
    photometry = PHOTOMETRY.model_copy(update={"prnu": 0.02, "dsnu_e": 10.0})
    a, b, other = (
        electrons(0.5, photometry, Shot(7, view, camera)) - 3000.0
        for view, camera in (("a", "left"), ("b", "left"), ("a", "right"))
    )
    n, pattern, whole = a.size, 60.0**2 + 10.0**2, 60.0**2 + 10.0**2 + 3000.0 + 64.0
    # The variance of a product of jointly normal numbers is that of both times (1 + correlation^2).
    z_same = ((a * b).mean() - pattern) / (whole * np.sqrt((1 + (pattern / whole) ** 2) / n))
    z_other = (a * other).mean() / (whole / np.sqrt(n))
    assert abs(z_same) < 3.3
    assert abs(z_other) < 3.3


def test_without_noise_the_converter_rounds_the_mean_signal() -> None:
    photometry = Photometry(
        full_well_e=1000.0, adc_bits=10, black_level_dn=23.0, blur_px=0.0, prnu=0.1, dsnu_e=50.0,
        dark_current_e_per_s=200.0, exposure_ms=50.0,
    )  # fmt: skip
    assert photometry.gain == 1.0
    light = np.array([[0.0, 0.2503, 0.5, 0.98, 1.7]], np.float32)
    expected = np.array([[33, 283, 533, 1013, 1023]])  # 10 dark electrons each
    np.testing.assert_array_equal(read_sensor(light, photometry, UNIT, None), expected)


def test_a_full_well_and_the_highest_code_both_end_the_reading() -> None:
    full = PHOTOMETRY.model_copy(update={"read_noise_e": 0.0, "gain_dn_per_e": 3.0})
    assert full.saturation_e == 6000.0
    assert (electrons(2.0, full, Shot(1, "a", "b")) == 6000.0).all()
    coded = full.model_copy(update={"gain_dn_per_e": 20.0})
    assert coded.saturation_e == (65535 - 2000) / 20.0
    assert (electrons(2.0, coded, Shot(1, "a", "b")) == coded.saturation_e).all()


def test_the_board_reaches_the_level_asked_for_and_stops_are_factors_of_two() -> None:
    radiance = np.array([0.3, 0.5, 0.4])
    light = np.broadcast_to(radiance, (40, 50, 3)).astype(np.float32)
    for stops, factor in ((0.0, 1.0), (1.0, 2.0), (-2.0, 0.25)):
        photometry = Photometry(bayer=True, white=0.5, exposure_stops=stops)
        exposure = exposure_for(photometry, radiance)
        share = expose(light, exposure)
        assert share.max() == pytest.approx(0.5 * factor, rel=1e-6)  # green, the strongest
        np.testing.assert_allclose(share[0, 0] * exposure.balance, 0.5 * factor, rtol=1e-6)


@pytest.mark.parametrize("bayer", [False, True])
def test_bands_leave_no_seams(bayer: bool, monkeypatch: pytest.MonkeyPatch) -> None:  # noqa: FBT001
    light = np.random.default_rng(0).random((150, 40, 3) if bayer else (150, 40), dtype=np.float32)
    photometry = Photometry(bayer=bayer)
    banded = read_sensor(light, photometry, UNIT, None)
    monkeypatch.setattr(bands, "ROWS", 1000)
    np.testing.assert_array_equal(banded, read_sensor(light, photometry, UNIT, None))


def test_the_noise_of_rows_does_not_depend_on_those_below() -> None:
    photometry = PHOTOMETRY.model_copy(update={"prnu": 0.02, "dsnu_e": 10.0})
    light = np.random.default_rng(0).random((150, 40), dtype=np.float32)
    whole = read_sensor(light, photometry, UNIT, Shot(1, "a", "b"))
    np.testing.assert_array_equal(read_sensor(light[:128], photometry, UNIT, Shot(1, "a", "b")), whole[:128])
    assert (whole[:64] != whole[64:128]).any()
