"""Exchanged pictures before known cameras, and cameras that moved."""

import pickle
from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.agreement.exchange.by_rays import refuse_exchanged_by_rays
from labcal.calibrate.agreement.exchange.decision import ExchangedPicturesError
from labcal.calibrate.agreement.finding import CauseName
from labcal.calibrate.triangulation_residuals import TriangulationResiduals
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.correspond.matching import Matches, match
from labcal.geometry.poses import from_rotation_vector
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]


@pytest.fixture
def matches(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> Matches:
    """Dots of a pair with 0.1 px of noise."""
    found = match(see(pair, grid, poses), tuple(pair))
    return replace(found, q=found.q + 0.1 * np.random.default_rng(3).standard_normal(found.q.shape))


def test_exchanged_pictures_are_told_with_cause_cameras_and_view(pair: Cameras, matches: Matches) -> None:
    refuse_exchanged_by_rays(tuple(pair.values()), matches)
    in_view = (matches.view == "pose-2")[:, None, None]
    exchanged = replace(matches, q=np.where(in_view, matches.q[:, ::-1], matches.q))
    with pytest.raises(ExchangedPicturesError, match="Pictures of 'left' and 'right' are exchanged") as told:
        refuse_exchanged_by_rays(tuple(pair.values()), exchanged)
    cause = pickle.loads(pickle.dumps(told.value)).cause  # noqa: S301 -- as a worker process hands it on
    assert cause == told.value.cause
    expected = (CauseName.SWAPPED_CAMERAS, ("left", "right"), ("pose-2",))
    assert (cause.cause, cause.cameras, cause.views) == expected


def test_a_camera_that_was_put_elsewhere_is_not_told_as_exchanged(
    see: See, pair: Cameras, grid: DotGrid, poses: Poses
) -> None:
    """An exchange that leaves many pixels explains nothing, even where no rays meet without it."""
    left, right = pair.values()
    beside, elsewhere = (
        replace(right, T_cam_world=from_rotation_vector(np.zeros(3), np.array(shift)))
        for shift in ([-20.0, 0.0, 0.0], [25.0, 6.0, 0.0])
    )
    seen = match(see({"left": left, "right": beside}, grid, poses), ("left", "right"))
    assert np.isinf(TriangulationResiduals.of((left, elsewhere), seen).typical_px)
    exchanged = replace(seen, q=seen.q[:, ::-1])
    assert 3.0 < TriangulationResiduals.of((left, elsewhere), exchanged).typical_px < 30.0
    refuse_exchanged_by_rays((left, elsewhere), seen)
