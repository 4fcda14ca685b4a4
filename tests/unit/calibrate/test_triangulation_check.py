"""Rays that miss each other by more than the calibration left are told, and no others."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.triangulation_check import calibration_record
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.reconstruct.reconstruction import Reconstruction, reconstruct_centres
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]
NOISE_PX = 0.02


@pytest.fixture
def dots(see: See, pair: Cameras, grid: DotGrid, poses: Poses) -> Detections:
    exact = see(pair, grid, poses)
    noise = NOISE_PX * np.random.default_rng(4).normal(size=exact.position.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(exact), 1, 1))
    return replace(exact, position=exact.position + noise, covariance=covariance)


def shifted(dots: Detections, y_px: float, view: str | None = None) -> Detections:
    of_right = (dots.camera == "right") & ((dots.view == view) | (view is None))
    return replace(dots, position=dots.position + of_right[:, None] * [0.0, y_px])


def rig_of(pair: Cameras, record: CalibrationRecord | None) -> Rig:
    return Rig.of(pair).model_copy(update={"calibration": record})


def flags(found: Reconstruction) -> set[str]:
    return set(found.points.flag.tolist())


def test_a_calibration_keeps_what_it_left(pair: Cameras, dots: Detections) -> None:
    record = calibration_record(list(pair.values()), match(dots, tuple(pair)))
    assert record.triangulation_rms_px == pytest.approx(NOISE_PX / np.sqrt(2.0), rel=0.1)
    assert record.scatter_px is not None
    assert record.scatter_px < NOISE_PX
    sharper = replace(dots, covariance=dots.covariance / 100.0)
    known = calibration_record(list(pair.values()), match(sharper, tuple(pair)))
    assert known.scatter_px == pytest.approx(NOISE_PX, rel=0.15)
    assert calibration_record([pair["left"]], match(dots, ("left",))).triangulation_rms_px is None


@pytest.mark.parametrize("y_px", [0.3, 1.5, -0.3])
def test_pictures_that_are_shifted_are_told(pair: Cameras, dots: Detections, y_px: float) -> None:
    rig = rig_of(pair, calibration_record(list(pair.values()), match(dots, tuple(pair))))
    good = reconstruct_centres(rig, dots, None)
    assert flags(good) == {"ok"}
    assert good.check is not None
    assert not good.check.assumed
    assert good.check.views == ()
    assert good.check.rms_px == pytest.approx(good.check.expected_px, rel=0.3)
    found = reconstruct_centres(rig, shifted(dots, y_px), None)
    assert flags(found) == {"model-misfit"}
    assert found.check is not None
    assert found.check.inconsistent
    assert found.check.rms_px > 5.0 * found.check.expected_px


def test_one_view_that_is_off_is_told_by_name(pair: Cameras, dots: Detections) -> None:
    rig = rig_of(pair, calibration_record(list(pair.values()), match(dots, tuple(pair))))
    found = reconstruct_centres(rig, shifted(dots, 0.3, "pose-3"), None)
    assert found.check is not None
    assert not found.check.inconsistent
    assert found.check.views == ("pose-3",)
    np.testing.assert_array_equal(found.points.flag == "model-misfit", found.points.view == "pose-3")


def test_a_rig_that_does_not_say_what_it_left_is_judged_with_a_floor(pair: Cameras, dots: Detections) -> None:
    rig = rig_of(pair, None)
    assert flags(reconstruct_centres(rig, shifted(dots, 0.1), None)) <= {"ok", "model-misfit"}
    small = reconstruct_centres(rig, shifted(dots, 0.1), None).check
    assert small is not None
    assert small.assumed
    assert small.views == ()
    assert flags(reconstruct_centres(rig, shifted(dots, 1.5), None)) == {"model-misfit"}


def test_points_of_a_contradictory_calibration_are_flagged(pair: Cameras, dots: Detections) -> None:
    record = CalibrationRecord(triangulation_rms_px=0.5, scatter_px=0.5, inconsistent=("unsynchronised",))
    assert flags(reconstruct_centres(rig_of(pair, record), dots, None)) == {"model-misfit"}
