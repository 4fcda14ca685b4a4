import numpy as np
import pytest

from labcal.bench.render.flat_fields import flat_fields
from labcal.bench.render.photon_transfer import PhotonTransfer, photon_transfer
from labcal.errors import InputError
from labcal.scene.photometry import Photometry
from labcal.scene.sensor_presets import PRESETS

COARSE = {
    "8 bits": {"adc_bits": 8, "full_well_e": 3000.0, "read_noise_e": 8.0, "black_level_dn": 8.0},
    "8 bits, steps above the noise": {
        "adc_bits": 8, "full_well_e": 3000.0, "read_noise_e": 5.0, "black_level_dn": 8.0
    },
    "14 bits and a gain of its own": {
        "adc_bits": 14, "gain_dn_per_e": 1.7, "black_level_dn": 200.0, "read_noise_e": 3.0
    },
}  # fmt: skip


def even_light(photometry: Photometry, side: int) -> np.ndarray:
    """Return a flat field that darkens to one side by a fifth."""
    row = np.linspace(1.0, 0.8, side, dtype=np.float32)
    light = np.tile(row, (side, 1))
    return np.stack([light] * 3, axis=-1) if photometry.bayer else light


def measured(photometry: Photometry) -> PhotonTransfer:
    return photon_transfer(*flat_fields(even_light(photometry, 256), photometry, seed=5))


def check(photometry: Photometry, limit: float) -> None:
    found = measured(photometry)
    for value, error, true in (
        (found.gain_dn_per_e, found.gain_error, photometry.gain),
        (found.read_noise_e, found.read_noise_error, photometry.read_noise_e),
        (found.full_well_e, found.full_well_error, photometry.saturation_e),
    ):
        assert abs(value / true - 1.0) < limit
        assert abs(value - true) < 3.3 * error + 1e-3 * true  # the read noise cuts 0.05% off a full well
        assert error < limit * true


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_every_preset_is_measured_as_it_is_described(name: str) -> None:
    check(Photometry.model_validate(name), 0.01)


@pytest.mark.parametrize("name", sorted(COARSE))
def test_other_converters_are_measured_too(name: str) -> None:
    check(Photometry.model_validate(COARSE[name]), 0.02)


def test_noise_far_below_the_converters_steps_is_not_told() -> None:
    photometry = Photometry(adc_bits=8, full_well_e=20000.0, read_noise_e=1.0, black_level_dn=8.0, prnu=0.01)
    found = measured(photometry)
    assert np.isnan(found.read_noise_e)
    assert np.isnan(found.read_noise_error)
    assert abs(found.gain_dn_per_e - photometry.gain) < 3.3 * found.gain_error


def test_the_curve_is_the_line_of_the_standard() -> None:
    photometry = Photometry.model_validate("machine-vision-5mp")
    found = measured(photometry)
    straight = photometry.gain * found.mean_dn + (photometry.gain * photometry.read_noise_e) ** 2
    linear = found.mean_dn < 0.7 * found.mean_dn.max()
    z = (found.variance_dn2 - straight)[linear] / (straight[linear] * np.sqrt(2.0 / 256**2))
    assert linear.sum() > 15
    assert (z**2).sum() < 45.0  # chi-square of 20, at 0.1%


def test_readings_that_cannot_tell_are_refused() -> None:
    photometry = Photometry(black_level_dn=64.0)
    dark, ladder = flat_fields(even_light(photometry, 64), photometry, seed=5)
    with pytest.raises(InputError, match="does not saturate every pixel"):
        photon_transfer(dark, ladder[:-1])
    with pytest.raises(InputError, match="Only 2 exposures"):
        photon_transfer(dark, [ladder[5], ladder[-1]])
    clipped = photometry.model_copy(update={"black_level_dn": 0.0})
    with pytest.raises(InputError, match="Raise black_level_dn"):
        photon_transfer(*flat_fields(even_light(clipped, 64), clipped, seed=5))
