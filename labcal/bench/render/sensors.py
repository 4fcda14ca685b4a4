"""The photon transfer curve of every preset, from rendered flat fields."""

import numpy as np

from labcal.bench.render.flat_fields import flat_fields
from labcal.bench.render.photon_transfer import photon_transfer
from labcal.report.bench import Check, at_most
from labcal.scene.photometry import Photometry
from labcal.scene.sensor_presets import PRESETS

SIDE = 512
LIMIT = 0.02


def sensor_checks(light: np.ndarray, seed: int) -> list[Check]:
    """Return the deviations of measured gain, read noise and full well from those of each preset.

    Parameters
    ----------
    light : ndarray of float32, shape (height, width)
        A rendered picture of an even surface.
    seed : int
    """
    checks = []
    for name in PRESETS:
        photometry = Photometry.model_validate({"preset": name})
        field = np.repeat(light[..., None], 3, axis=-1) if photometry.bayer else light
        found = photon_transfer(*flat_fields(field, photometry, seed))
        for what, value, true in (
            ("gain", found.gain_dn_per_e, photometry.gain),
            ("read noise", found.read_noise_e, photometry.read_noise_e),
            ("full well", found.full_well_e, photometry.full_well_e),
        ):
            checks.append(at_most(f"{what} of {name}, relative error", abs(value / true - 1.0), LIMIT))
    return checks
