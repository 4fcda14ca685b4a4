"""Lens models that the files of other systems hold, found by writing each."""

from dataclasses import replace

import numpy as np

from labcal.cameras.camera import Camera
from labcal.cameras.interop.exchange import RigFormat
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.lens import LENGTH, LENSES
from labcal.cameras.rig import Rig
from labcal.errors import InputError

_STEP = 1e-4
"""Added to each coefficient, so that none is left out unseen; it bends nothing."""
_SIZE = (640, 480)
_K = np.array([[600.0, 0.0, 319.5], [0.0, 600.0, 239.5], [0.0, 0.0, 1.0]])
_BASELINE_MM = 100.0


def holds(one: RigFormat, lens: str) -> bool:
    """Tell whether a format holds cameras with a lens model, all of its coefficients included.

    Raises
    ------
    KeyError
        There is no such lens model.
    """
    rig = _pair(lens)
    try:
        one.write(rig, one.suffixes[0] if one.suffixes else "")
    except InputError:
        return False
    return True


def held_lenses(one: RigFormat) -> tuple[str, ...]:
    """Return the names of the lens models whose cameras a format holds."""
    return tuple(lens for lens in LENSES if holds(one, lens))


def holding_formats(lens: str) -> tuple[str, ...]:
    """Return the names of the formats that hold cameras with a lens model."""
    return tuple(name for name, one in FORMATS.items() if holds(one, lens))


def _pair(lens: str) -> Rig:
    """Return two cameras beside each other."""
    model = LENSES[lens]
    dist = np.zeros(max(LENGTH, model.coefficients))
    dist[: model.coefficients] = model.undistorted  # which may be no zeros
    dist[: model.coefficients] += _STEP * (1.0 + np.arange(model.coefficients))
    left = Camera(_K, lens, dist, np.eye(4), _SIZE)
    T = np.eye(4)
    T[0, 3] = -_BASELINE_MM
    return Rig.of({"left": left, "right": replace(left, T_cam_world=T)})
