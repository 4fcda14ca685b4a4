"""A calibrated pair, and dots of new views of it after a change; images of centres with noise."""

from dataclasses import replace
from functools import cache

import numpy as np

from labcal import Detections, Rig
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.check_set import simulated_target
from labcal.bench.solve.pair_dots import pair_dots
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.validity.change import Change, ChangeKind
from labcal.rng import generator

KIND = KINDS["wide"]
TARGET = simulated_target(KIND)
NOISE_PX = 0.05


def seen(change: Change | None, size: list[float], views: int = 3, seed: int = 0) -> Detections:
    """Return dots of new views after a change of the true cameras."""
    random = generator(seed, "new views")
    state = RigState(KIND.cameras(), np.array(KIND.poses(views, random)), TARGET.points())
    if change is not None:
        state = change.applied(state, np.array(size))
    noise = (NOISE_PX, random)
    return pair_dots(state.cameras, TARGET, state.dots, list(state.T_world_target), noise)


@cache
def rig() -> Rig:
    """Return the rig from 12 views."""
    random = generator(0, "calibration")
    views = KIND.poses(12, random)
    dots = pair_dots(KIND.cameras(), TARGET, TARGET.points(), views, (NOISE_PX, random))
    dots = replace(dots, view=np.char.add("cal-", dots.view.astype(str)))
    found = calibrate_handheld(dots, TARGET, "brown5", HandheldSettings(eccentricity_rounds=0))
    return found.rig.model_copy(update={"calibrated_on": dots.views})


def one(kind: str, camera: int) -> Change:
    """Return a change of one camera."""
    return Change(ChangeKind(kind), (camera,), (camera,))
