"""Presets of sensors by name: values of common devices."""

from collections.abc import Mapping

from labcal.arguments import one_named

# A preset is a device at its lowest gain and at room temperature. Every one has a black level some ten times
# its read noise, as real converters have, so that the noise of the dark is not cut off at code 0.
PRESETS: Mapping[str, Mapping[str, object]] = {
    # A webcam of the year 2000: VGA, Bayer mosaic, 10 bits, a plastic lens that blurs, JPEG. No data
    # sheet states it in these terms; reasoned: a small CMOS pixel with half its area for light holds some
    # thousand electrons (6000 give 38 dB signal to noise at most), reads with about 8 e-, and patterns were
    # its weak side: 1% of the signal, and offsets near the read noise. Indoors it exposes for 1/30 s.
    "webcam-2000": {
        "bayer": True,
        "blur_px": 0.8,
        "exposure_ms": 33.0,
        "full_well_e": 6000.0,
        "read_noise_e": 8.0,
        "dark_current_e_per_s": 100.0,
        "prnu": 0.01,
        "dsnu_e": 5.0,
        "adc_bits": 10,
        "black_level_dn": 16.0,
        "fall_off": True,
        "jpeg_quality": 95,
    },
    # A digital still camera of that time, in grey, with 12 bits. Reasoned: a CCD holds about 2 ke- a um2, so
    # 30 ke- are pixels of 4 um; all of them are read by one amplifier (6 e-), so patterns are weak. A zoom
    # lens near full aperture vignettes a little.
    "still-2000": {
        "blur_px": 0.6,
        "exposure_ms": 10.0,
        "full_well_e": 30000.0,
        "read_noise_e": 6.0,
        "dark_current_e_per_s": 50.0,
        "prnu": 0.005,
        "dsnu_e": 2.0,
        "adc_bits": 12,
        "black_level_dn": 64.0,
        "fall_off": True,
        "vignetting": 0.05,
        "jpeg_quality": 97,
    },
    # A Sony IMX250 (2464 x 2056 pixels of 3.45 um, global shutter, 12 bits) as makers of cameras state it
    # after EMVA 1288: saturation 10.5 to 10.7 ke- (signal to noise at most 40.3 dB), temporal dark noise
    # 2.3 to 2.4 e-, DSNU below 1 e-, PRNU 0.4 to 0.5%; dark current a few e-/s at the sensor's 40 to 45 C.
    # Delivered linear and without loss, as one measures with it.
    "machine-vision-5mp": {
        "blur_px": 0.6,
        "exposure_ms": 5.0,
        "full_well_e": 10500.0,
        "read_noise_e": 2.4,
        "dark_current_e_per_s": 3.0,
        "prnu": 0.004,
        "dsnu_e": 0.8,
        "adc_bits": 12,
        "black_level_dn": 16.0,
        "fall_off": True,
        "tone_curve": "linear",
        "format": "png",
    },
    # A phone's main camera: pixels of 1.4 um with about 3 ke- a um2, 10 bits above a black level of 64. The
    # 1.5 e- that makers state hold at high gain; at the lowest gain the converter's own noise (half a code,
    # 3 to 4 e-) rules. The phone's software flattens the fall-off of its lens.
    "phone": {
        "bayer": True,
        "blur_px": 0.7,
        "exposure_ms": 10.0,
        "full_well_e": 6000.0,
        "read_noise_e": 4.0,
        "dark_current_e_per_s": 15.0,
        "prnu": 0.008,
        "dsnu_e": 1.0,
        "adc_bits": 10,
        "black_level_dn": 64.0,
        "jpeg_quality": 95,
    },
}


def expanded(value: object) -> object:
    """Return a description of a sensor with the keys of its preset written out.

    Parameters
    ----------
    value : object
        The name of a preset, or a mapping whose key ``preset`` names one and whose other keys change it.
        Anything else is returned as it is.

    Raises
    ------
    UnknownNameError
        There is no such preset; the nearest one is offered.
    """
    if isinstance(value, str):
        value = {"preset": value}
    if not isinstance(value, dict) or "preset" not in value:
        return value
    changes = dict(value)
    name = str(changes.pop("preset"))
    return {**one_named(PRESETS, "preset of a sensor", name), **changes}
