"""Budgets of points, and values from several points, against cameras and pixels that are drawn anew."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chi2

import labcal
from labcal import InputError, Points, Reconstruction, Rig, examples
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.rig_covariance import RigCovariance, parameter_names
from labcal.cameras.triangulation import triangulate
from labcal.cameras.triangulation_derivatives import triangulation_derivatives
from labcal.reconstruct.point_budget import Budget, PointBudget

SIGMA = np.array(
    [*([0.3] * 4 + [1e-3, 5e-3, 2e-4, 2e-4, 1e-2]) * 2, 2e-4, 3e-4, 1e-4, 0.05, 0.03, 0.1]
)  # px, 1, rad, mm
"""Of the parameters of the example's rig."""
DRAWS = 100
NOISE = np.array([[[4e-4, 1e-4], [1e-4, 2e-4]], [[1e-4, 0.0], [0.0, 9e-4]]])
"""Of the pixels of both cameras."""


def covariance() -> np.ndarray:
    """Return a covariance with correlations of all parameters."""
    n = len(SIGMA)
    mix = np.eye(n) + 0.2 * np.random.default_rng(1).standard_normal((n, n))
    return np.outer(SIGMA, SIGMA) * (mix @ mix.T)


def rig() -> Rig:
    plain = examples.rig()
    return plain.model_copy(update={"covariance": RigCovariance.of(plain.cameras, covariance())})


def stepped(cameras: Sequence[Camera], step: np.ndarray) -> tuple[Camera, ...]:
    state = RigState(tuple(cameras), np.eye(4)[None], np.zeros((1, 3)))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
    return layout.stepped(step, np.zeros((1, 6))).cameras


CAMERAS = tuple(examples.rig().camera(name) for name in ("left", "right"))
TRUE = np.random.default_rng(2).uniform([-40.0, -60.0, 500.0], [140.0, 60.0, 700.0], (12, 3))
TRUE[9:] = TRUE[:3] + np.array([0.5, -0.2, 0.3])
CLEAN = np.stack([camera.project(TRUE).q for camera in CAMERAS], axis=1)
PIXELS = np.tile(NOISE, (len(TRUE), 1, 1, 1))


def reconstruction(of: Rig, point: np.ndarray, wanted: Budget | None = None) -> Reconstruction:
    n = len(point)
    budget = PointBudget.of(of, point, PIXELS, wanted)
    points = Points(
        ["a"] * n, np.zeros((n, 2), np.int64), point, budget.noise + budget.calibration, ["ok"] * n
    )
    return Reconstruction(points, None, None, None, budget=budget)


@pytest.fixture(scope="module")
def drawn() -> list[np.ndarray]:
    """Return points triangulated with other cameras and other noise each time."""
    rng, root = np.random.default_rng(3), np.linalg.cholesky(covariance())
    of_pixels = np.linalg.cholesky(NOISE)
    found = []
    for _ in range(DRAWS):
        cameras = stepped(CAMERAS, root @ rng.standard_normal(len(root)))
        noise = np.einsum("cij,ncj->nci", of_pixels, rng.standard_normal(CLEAN.shape))
        found.append(triangulate(cameras, CLEAN + noise, PIXELS).point)
    return found


def agree(errors: np.ndarray, stated: np.ndarray) -> bool:
    """Tell whether errors, (draws, k), are as large as stated: a two-sided chi-square test at 0.1%."""
    square = float(np.einsum("di,ij,dj->", errors, np.linalg.inv(stated), errors))
    low, high = chi2.ppf([5e-4, 0.9995], errors.size)
    return bool(low < square < high)


def test_derivatives_are_those_of_triangulation() -> None:
    by = triangulation_derivatives(CAMERAS, TRUE, PIXELS)
    for number, sigma in enumerate(SIGMA):
        step = np.zeros(len(SIGMA))
        step[number] = 1e-3 * sigma
        moved = [triangulate(stepped(CAMERAS, sign * step), CLEAN, PIXELS).point for sign in (1, -1)]
        difference = (moved[0] - moved[1]) / (2e-3 * sigma)
        np.testing.assert_allclose(by[:, :, number], difference, rtol=1e-5, atol=1e-5 * np.abs(by).max())


def test_points_scatter_as_stated(drawn: list[np.ndarray]) -> None:
    budget = PointBudget.of(rig(), TRUE, PIXELS, None)
    errors = np.array([(point - TRUE)[:3].ravel() for point in drawn])
    joint = budget.joint([0, 1, 2])
    assert agree(errors, joint)
    assert not agree(errors, PointBudget.of(rig(), TRUE, PIXELS, Budget.NOISE).joint([0, 1, 2]))


def test_the_joint_covariance_has_each_points_own_on_its_diagonal() -> None:
    budget = PointBudget.of(rig(), TRUE, PIXELS, None)
    own = budget.noise + budget.calibration
    np.testing.assert_allclose(budget.joint([4])[:3, :3], own[4], rtol=1e-9)


def test_distances_and_angles_scatter_as_stated(drawn: list[np.ndarray]) -> None:
    truth = reconstruction(rig(), TRUE)
    lengths = np.array([np.linalg.norm(point[0] - point[5]) for point in drawn])
    length = labcal.distance(truth, 0, 5)
    assert agree((lengths - length.value)[:, None], np.array([[length.sigma**2]]))
    assert length.sigma**2 == pytest.approx(length.noise_sigma**2 + length.calibration_sigma**2)
    angles = []
    for point in drawn:
        a, b = point[1] - point[0], point[5] - point[0]
        angles.append(np.arccos(a @ b / np.linalg.norm(a) / np.linalg.norm(b)))
    angle = labcal.angle(truth, 0, 1, 5)
    assert agree((np.array(angles) - angle.value)[:, None], np.array([[angle.sigma**2]]))


def test_near_points_share_the_errors_of_the_calibration() -> None:
    truth = reconstruction(rig(), TRUE)
    near = labcal.distance(truth, 0, 9)
    alone = np.sqrt(np.trace(truth.budget.calibration[0]))
    assert near.calibration_sigma < 0.02 * alone


def test_planes_scatter_as_stated() -> None:
    lines = [0, 3, 4, 6, 8]
    on_plane = TRUE.copy()
    on_plane[lines, 2] = 600.0 + 0.1 * TRUE[lines, 0]
    clean = np.stack([camera.project(on_plane).q for camera in CAMERAS], axis=1)
    exact = triangulate(CAMERAS, clean, PIXELS).point
    assert np.abs(exact - on_plane).max() < 1e-6
    truth = labcal.plane(reconstruction(rig(), on_plane), lines)
    assert truth.rms_mm < 1e-9
    assert truth.normal @ on_plane[0] < 0.0
    rng, root = np.random.default_rng(4), np.linalg.cholesky(covariance())
    of_pixels = np.linalg.cholesky(NOISE)
    errors = []
    for _ in range(DRAWS // 2):
        cameras = stepped(CAMERAS, root @ rng.standard_normal(len(root)))
        noise = np.einsum("cij,ncj->nci", of_pixels, rng.standard_normal(CLEAN.shape))
        found = labcal.plane(reconstruction(rig(), triangulate(cameras, clean + noise, PIXELS).point), lines)
        slopes = -(truth.axes[:2] @ found.normal) / (truth.normal @ found.normal)
        height = (found.centre - truth.centre) @ found.normal / (truth.normal @ found.normal)
        errors.append([height, *slopes])
    assert agree(np.array(errors), truth.shares.total)


def test_rigid_motions_scatter_as_stated(drawn: list[np.ndarray]) -> None:
    truth = labcal.rigid_motion(reconstruction(rig(), TRUE), [0, 1, 2], [9, 10, 11])
    np.testing.assert_allclose(truth.displacement_mm, [0.5, -0.2, 0.3], atol=1e-9)
    assert truth.rms_mm < 1e-9
    errors = []
    for point in drawn:
        found = labcal.rigid_motion(reconstruction(rig(), point), [0, 1, 2], [9, 10, 11])
        errors.append([*(found.displacement_mm - truth.displacement_mm), *found.rotation_rad])
    assert agree(np.array(errors), truth.shares.total)


def test_the_variance_component_widens_the_noise_alone() -> None:
    widened = rig().model_copy(update={"calibration": CalibrationRecord(scatter_px=0.05)})
    plain, wide = (PointBudget.of(one, TRUE, PIXELS, None) for one in (rig(), widened))
    np.testing.assert_array_equal(plain.calibration, wide.calibration)
    even = np.tile(1e-4 * np.eye(2), (len(TRUE), 2, 1, 1))  # then both widen alike
    plain, wide = (PointBudget.of(one, TRUE, even, None) for one in (rig(), widened))
    np.testing.assert_allclose(wide.noise, plain.noise * (1.0 + 0.05**2 / 1e-4), rtol=1e-9)


def test_a_rig_without_covariance_gives_the_noise_alone() -> None:
    known = reconstruction(examples.rig(), TRUE)
    assert known.budget.kind is Budget.NOISE
    assert not known.budget.calibration.any()
    assert labcal.distance(known, 0, 5).calibration_sigma == 0.0
    with pytest.raises(InputError, match=r"Calibrate again.*`budget`"):
        PointBudget.of(examples.rig(), TRUE, PIXELS, Budget.FULL)


def test_points_without_a_solution_are_refused_by_number() -> None:
    lost = TRUE.copy()
    lost[3] = np.nan
    found = reconstruction(rig(), lost)
    assert np.isnan(found.budget.calibration[3]).all()
    assert np.isfinite(found.budget.calibration[4]).all()
    with pytest.raises(InputError, match="Point 3"):
        labcal.distance(found, 1, 3)
    with pytest.raises(InputError, match="twice"):
        labcal.distance(found, 1, 1)
    with pytest.raises(InputError, match="numbers of lines"):
        labcal.distance(found, 1, 99)
    with pytest.raises(InputError, match="on one line"):
        labcal.plane(reconstruction(rig(), np.linspace(TRUE[0], TRUE[1], len(TRUE))), [0, 3, 5, 9])


def test_points_of_a_method_have_no_joint_covariance() -> None:
    found = replace(reconstruction(rig(), TRUE), budget=None)
    with pytest.raises(InputError, match="fitted method"):
        labcal.distance(found, 0, 1)


def test_names_of_parameters_are_in_the_order_of_the_adjustment() -> None:
    names = parameter_names(examples.rig().cameras)
    state = RigState(CAMERAS, np.eye(4)[None], np.zeros((1, 3)))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
    assert len(names) == layout.count
    assert names[layout.lens[1].start] == "right.fx"
    assert names[layout.pose[1].start] == "right.turn_x"
