"""Baselines and angles with their sigmas, against poses that are changed a little."""

from dataclasses import replace

import numpy as np
import pytest

from labcal import Rig, examples
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.rig_covariance import RigCovariance, parameter_names
from labcal.errors import UnknownNameError
from labcal.geometry.poses import from_rotation_vector

STEP = 1e-6


def three() -> Rig:
    """Return the example's rig with a third camera, above the others and turned."""
    left, right = (examples.rig().camera(name) for name in ("left", "right"))
    T = from_rotation_vector(np.array([0.2, -0.1, 0.3]), np.array([-30.0, 150.0, 20.0]))
    return Rig.of({"left": left, "right": right, "top": replace(left, T_cam_world=T)})


def covariance(rig: Rig) -> np.ndarray:
    """Return a covariance of all parameters with correlations."""
    names = parameter_names(rig.cameras)
    sigma = np.where(["turn" in name for name in names], 1e-3, 0.1)
    mix = np.eye(len(names)) + 0.3 * np.random.default_rng(1).standard_normal((len(names), len(names)))
    return np.outer(sigma, sigma) * (mix @ mix.T)


def changed(rig: Rig, step: np.ndarray) -> Rig:
    """Return the rig with its parameters changed, by the adjustment's own rules."""
    cameras = tuple(rig.camera(name) for name in rig.cameras)
    layout = Layout(
        RigState(cameras, np.eye(4)[None], np.zeros((1, 3))), Freedom(Lenses.FREE, np.zeros((3, 0)))
    )
    stepped = layout.stepped(step, np.zeros((1, 6))).cameras
    return Rig.of(dict(zip(rig.cameras, stepped, strict=True)))


@pytest.mark.parametrize("names", [("left", "right"), ("left", "top"), ("right", "top"), ("top", "left")])
def test_sigmas_are_propagated_from_the_joint_covariance(names: tuple[str, str]) -> None:
    plain = three()
    C = covariance(plain)
    rig = plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, C)})
    pair = rig.pair(*names)
    by = []
    for step in STEP * np.eye(len(C)):
        ahead, behind = (changed(plain, sign * step).pair(*names) for sign in (1.0, -1.0))
        by.append([ahead.baseline_mm - behind.baseline_mm, ahead.angle_deg - behind.angle_deg])
    by_parameters = np.array(by).T / (2.0 * STEP)
    sigma = np.sqrt(np.diagonal(by_parameters @ C @ by_parameters.T))
    assert [pair.baseline_sigma_mm, pair.angle_sigma_deg] == pytest.approx(sigma.tolist(), rel=1e-4)
    assert pair.baseline_mm == pytest.approx(rig.baseline_mm(*names))


def test_cameras_side_by_side_have_an_angle_of_nothing_and_its_sigma() -> None:
    left = examples.rig().camera("left")
    beside = np.eye(4)
    beside[0, 3] = -100.0
    plain = Rig.of({"left": left, "right": replace(left, T_cam_world=beside)})
    C = np.zeros((24, 24))
    C[-6:-3, -6:-3] = np.diag([1e-3, 2e-3, 9e-3]) ** 2  # the turn about the axis itself changes no angle
    pair = plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, C)}).pair("left", "right")
    assert pair.angle_deg == 0.0
    assert pair.angle_sigma_deg == pytest.approx(np.degrees(2e-3))


def test_a_rig_without_covariance_states_no_sigmas() -> None:
    pair = examples.rig().pair("left", "right")
    assert np.isnan([pair.baseline_sigma_mm, pair.angle_sigma_deg]).all()
    assert np.isfinite([pair.baseline_mm, pair.angle_deg]).all()


def test_an_unknown_camera_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="middle"):
        examples.rig().pair("left", "middle")
