"""Errors to expect of a rig, against the budgets of points at the same places."""

from math import nan

import numpy as np
import pytest

from labcal import InputError, Rig, examples, load_target, pipeline
from labcal.calibrate.calibration import Calibration
from labcal.cameras.expected_errors import expected_errors
from labcal.reconstruct.point_budget import Budget, PointBudget
from labcal.report.calibrate_result import calibrate_result

SIGMA_PX = 0.05


@pytest.fixture(scope="module")
def made() -> Calibration:
    return pipeline.calibrate(load_target(examples.TARGET), examples.detections())


def test_shares_are_those_of_the_points_budget(made: Calibration) -> None:
    p = np.random.default_rng(4).uniform([20.0, -40.0, 520.0], [80.0, 40.0, 640.0], (200, 3))
    expected = made.rig.expected_errors(p, SIGMA_PX)
    pixels = np.tile(SIGMA_PX**2 * np.eye(2), (len(p), 2, 1, 1))
    noise = PointBudget.of(made.rig, p, pixels, Budget.NOISE).noise
    calibration = PointBudget.of(made.rig, p, pixels, Budget.FULL).calibration
    for covariance, depth, sideways in (
        (noise, expected.depth.noise_mm, expected.sideways.noise_mm),
        (calibration, expected.depth.calibration_mm, expected.sideways.calibration_mm),
    ):
        along = p - np.mean([made.rig.camera(name).centre for name in made.rig.cameras], axis=0)
        along /= np.linalg.norm(along, axis=1)[:, None]
        squares = np.array([v @ C @ v for v, C in zip(along, covariance, strict=True)])
        assert depth**2 == pytest.approx(squares.mean(), rel=1e-6)
        total = float(np.trace(covariance, axis1=1, axis2=2).mean())
        assert depth**2 + 2.0 * sideways**2 == pytest.approx(total, rel=1e-6)
    assert expected.depth.total_mm == pytest.approx(
        np.hypot(expected.depth.noise_mm, expected.depth.calibration_mm)
    )


def test_a_calibration_expects_errors_where_the_target_was(made: Calibration) -> None:
    expected = made.expected_errors()
    assert expected.nearest_mm < expected.distance_mm < expected.farthest_mm
    seen = np.linalg.norm(examples.points().point - [100.0, 0.0, 0.0], axis=1)
    assert expected.distance_mm == pytest.approx(float(np.median(seen)), rel=0.02)
    assert expected.pixel_sigma_px == pytest.approx(examples.SIGMA_PX, rel=0.1)
    assert 0.0 <= expected.depth.print_mm < expected.depth.calibration_mm
    assert 0.0 < expected.shape_mm < np.hypot(expected.depth.calibration_mm, expected.sideways.calibration_mm)


def test_baseline_and_angle_are_within_their_sigmas_of_the_truth(made: Calibration) -> None:
    (pair,) = made.pairs()
    true = examples.rig().pair("left", "right")
    assert abs(pair.baseline_mm - true.baseline_mm) < 3.0 * pair.baseline_sigma_mm
    assert abs(pair.angle_deg - true.angle_deg) < 3.0 * pair.angle_sigma_deg
    assert pair.baseline_sigma_mm < 0.1


def test_the_document_has_them(made: Calibration) -> None:
    document = calibrate_result(made, examples.detections(), load_target(examples.TARGET))
    expected = made.expected_errors()
    assert document.expected_errors.depth.total_mm == expected.depth.total_mm
    assert document.expected_errors.sideways.calibration_mm == expected.sideways.calibration_mm
    assert document.pairs == list(made.pairs())


def test_kept_lenses_leave_the_calibrations_share_unknown(made: Calibration) -> None:
    settings = pipeline.HandheldSettings(lenses="fixed", start=made.rig)
    kept = pipeline.calibrate(examples.TARGET, examples.detections(), None, settings)
    expected = kept.expected_errors()
    assert np.isnan(expected.depth.calibration_mm)
    assert expected.depth.total_mm == expected.depth.noise_mm


def test_one_camera_gives_no_depth() -> None:
    camera = examples.rig().camera("left")
    found = expected_errors([camera], None, np.array([[0.0, 0.0, 400.0]]), [0.1])
    assert found.sideways.noise_mm == pytest.approx(400.0 * 0.1 / 800.0)
    assert np.isnan(found.depth.noise_mm)


def test_places_that_no_camera_sees_give_nothing() -> None:
    assert np.isnan(examples.rig().expected_errors([[0.0, 0.0, -500.0]], SIGMA_PX).distance_mm)


@pytest.mark.parametrize("sigma", [0.0, -1.0, nan])
def test_a_sigma_that_is_none_is_refused(sigma: float) -> None:
    rig: Rig = examples.rig()
    with pytest.raises(InputError, match="`pixel_sigma_px` must be a positive number of px"):
        rig.expected_errors([[0.0, 0.0, 600.0]], sigma)
