"""A target held before two cameras, of which the second may see it elsewhere."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.solve.held_rig import NOISE_PX, HeldRig
from labcal.calibrate.adjustment.state import RigState
from labcal.correspond.detections import Detections
from labcal.geometry.poses import from_rotation_vector

Seen = Callable[..., Detections]


def _seen(views: int, seed: int, moved: dict[int, np.ndarray] | None = None) -> Detections:
    """Return dots; in some views the second camera has turned (rad) and moved (mm) by six numbers."""
    held = HeldRig.drawn(views, seed)
    first, second = held.truth.cameras
    noise = NOISE_PX * np.random.default_rng(seed).standard_normal(held.observations.q.shape)
    blank = replace(held.observations, q=np.zeros_like(held.observations.q))
    q = held.truth.residuals(blank) + noise
    for view, step in (moved or {}).items():
        elsewhere = from_rotation_vector(step[:3], step[3:]) @ second.T_cam_world
        other = RigState(
            (first, replace(second, T_cam_world=elsewhere)), held.truth.T_world_target, held.truth.dots
        )
        rows = (blank.view == view) & (blank.camera == 1)
        q[rows] = (other.residuals(blank) + noise)[rows]
    return replace(held, observations=replace(blank, q=q)).detections()


@pytest.fixture
def seen() -> Seen:
    """Return what makes the dots of a number of views and a seed."""
    return _seen
