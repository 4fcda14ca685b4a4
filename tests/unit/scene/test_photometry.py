import pytest
from pydantic import ValidationError

from labcal.errors import InputError
from labcal.scene.catalogue import load_scene
from labcal.scene.photometry import Photometry, PictureFormat
from labcal.scene.sensor_presets import PRESETS
from labcal.shoot.tone_curve import ToneCurve


def test_a_sensor_left_at_its_defaults_has_no_defect() -> None:
    plain = Photometry()
    assert (plain.prnu, plain.dsnu_e, plain.dark_current_e_per_s, plain.vignetting) == (0.0, 0.0, 0.0, 0.0)
    assert not plain.fall_off


@pytest.mark.parametrize("name", sorted(PRESETS))
def test_presets_are_sensors_whose_dark_is_not_cut_off(name: str) -> None:
    preset = Photometry.model_validate(name)
    dark_noise = preset.gain * (preset.read_noise_e**2 + preset.dsnu_e**2 + preset.dark_e) ** 0.5
    assert preset.black_level_dn > 6 * dark_noise
    assert preset.saturation_e == preset.full_well_e
    assert preset.gain * preset.read_noise_e > 0.5  # else the converter's steps hide the noise


@pytest.mark.parametrize(
    ("update", "gain", "saturation"),
    [
        ({}, 4095 / 20000, 20000.0),
        ({"black_level_dn": 95.0}, 0.2, 20000.0),
        ({"gain_dn_per_e": 0.1}, 0.1, 20000.0),
        ({"gain_dn_per_e": 0.5, "black_level_dn": 95.0}, 0.5, 8000.0),
    ],
)
def test_the_gain_is_that_of_a_full_well_unless_given(
    update: dict[str, float], gain: float, saturation: float
) -> None:
    photometry = Photometry.model_validate(update)
    assert photometry.gain == pytest.approx(gain)
    assert photometry.saturation_e == pytest.approx(saturation)


@pytest.mark.parametrize(
    ("given", "what"),
    [
        ({"prnu": -0.1}, "prnu"),
        ({"dsnu_e": -1}, "dsnu_e"),
        ({"dark_current_e_per_s": -1}, "dark_current_e_per_s"),
        ({"read_noise_e": float("nan")}, "read_noise_e"),
        ({"exposure_ms": 0}, "exposure_ms"),
        ({"gain_dn_per_e": 0}, "gain_dn_per_e"),
        ({"vignetting": 1.0}, "vignetting"),
        ({"bits": 12}, "bits"),
        ({"adc_bits": 10, "black_level_dn": 1023}, "below the highest code of 10 bits, 1023"),
        ({"bits": 16}, "JPEG holds 8 bits"),
        ({"stage": "raw"}, "png or tif, not jpg"),
        ({"stage": "raw", "format": "exr"}, "png or tif, not exr"),
        ("webcam-200", "Did you mean 'webcam-2000'"),
        ({"preset": "fone"}, "Did you mean 'phone'"),
        ({"preset": 5}, "named '5'"),
    ],
)
def test_what_cannot_be_is_named(given: object, what: str) -> None:
    with pytest.raises(ValidationError) as caught:
        Photometry.model_validate(given)
    assert what in str(caught.value)


def test_a_preset_with_changes_keeps_the_rest() -> None:
    changed = Photometry.model_validate({"preset": "webcam-2000", "jpeg_quality": 40})
    assert changed == Photometry.model_validate("webcam-2000").model_copy(update={"jpeg_quality": 40})


@pytest.mark.parametrize(
    "overrides",
    [
        ("photometry=machine-vision-5mp", "photometry.bits=16", "photometry.tone_curve=srgb"),
        ("photometry.preset=machine-vision-5mp", "photometry.bits=16", "photometry.tone_curve=srgb"),
        ("photometry={preset: machine-vision-5mp, bits: 16}", "photometry.tone_curve=srgb"),
        ("photometry=phone", "photometry={preset: machine-vision-5mp, tone_curve: srgb, bits: 16}"),
    ],
)
def test_presets_on_the_command_line_replace_what_stood_there(overrides: tuple[str, ...]) -> None:
    found = load_scene("webcam-plane", overrides).photometry
    assert found == Photometry.model_validate(
        {"preset": "machine-vision-5mp", "bits": 16, "tone_curve": "srgb"}
    )
    assert (found.full_well_e, found.format) == (10500.0, PictureFormat.PNG)
    assert found.tone_curve is ToneCurve.SRGB


def test_a_description_without_a_preset_starts_from_the_defaults() -> None:
    found = load_scene("webcam-plane", ("photometry={bayer: on}", "photometry.adc_bits=14")).photometry
    assert found == Photometry(bayer=True, adc_bits=14)


def test_keys_can_be_set_in_any_order() -> None:
    found = load_scene("webcam-plane", ("photometry.bits=16", "photometry.format=tif")).photometry
    assert (found.bits, found.format) == (16, PictureFormat.TIFF)


def test_an_unknown_preset_on_the_command_line_is_answered_with_the_nearest() -> None:
    with pytest.raises(
        InputError, match=r"no preset of a sensor named 'still-200'\. Did you mean 'still-2000'"
    ):
        load_scene("webcam-plane", ("photometry=still-200",))
    with pytest.raises(InputError, match="photometry"):
        load_scene("webcam-plane", ("photometry=5",))


def test_a_target_set_by_name_can_be_changed_further() -> None:
    target = load_scene("webcam-plane", ("target=rings-10x8", "target.margin_mm=3")).target
    assert (target.name, target.margin_mm) == ("rings-10x8", 3.0)
