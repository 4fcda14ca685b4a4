"""Data of arms: paired at a seed, seen by the cameras they name, and an oracle that knows these."""

import numpy as np
import pytest
from scipy.optimize import least_squares

from labcal.errors import InputError
from labcal.paper.claims.arm_data import arm_problem
from labcal.paper.claims.arm_run import ArmRun, arm_figures
from labcal.paper.claims.plan import ORACLE, Arm, ArmData, ArmNoise
from labcal.paper.simulated import FOCAL_LENGTH_MM, FOCAL_RATIO, PIXEL_MM, TESTS, cameras

SIMULATED = [data for data in ArmData if "pictures" not in data]
POINTS = {ArmData.FOCAL_LENGTHS: 200, ArmData.POSITIONS: 130}


def _arm(data: ArmData, **changes: object) -> Arm:
    return Arm.model_validate({"data": data, "points": POINTS.get(data, 250), **changes})


@pytest.mark.parametrize("data", SIMULATED)
def test_arms_of_one_seed_share_points_and_noise(data: ArmData) -> None:
    noisy = {"noise": ArmNoise.PIXEL}
    one = arm_problem(_arm(data, **noisy), 3)
    same = arm_problem(_arm(data, **noisy, method="affine", goal=1e-3), 3)
    other = arm_problem(_arm(data, **noisy), 4)
    clean = arm_problem(_arm(data), 3)
    np.testing.assert_array_equal(one.problem.X, same.problem.X)
    np.testing.assert_array_equal(one.problem.Y_test, same.problem.Y_test)
    assert not np.array_equal(one.problem.Y_test, other.problem.Y_test)
    noise = one.problem.X_test - clean.problem.X_test
    assert noise.std() == pytest.approx(0.05, rel=4 / np.sqrt(2 * noise.size))
    assert len(one.problem.Y_test) == TESTS
    assert not {tuple(p) for p in one.problem.Y.tolist()} & {tuple(p) for p in one.problem.Y_test.tolist()}


@pytest.mark.parametrize("data", [ArmData.PLANE, ArmData.VOLUME, ArmData.POSITIONS, ArmData.DISTORTED_VOLUME])
def test_the_named_cameras_see_the_points(data: ArmData) -> None:
    """The conversion of the paper's cameras is tested against the paper's own equations elsewhere."""
    found = arm_problem(_arm(data, k1=-0.3 if data is ArmData.DISTORTED_VOLUME else 0.0), 0)
    world = found.problem.Y_test[:, :3].copy()
    if data is ArmData.POSITIONS:  # points count in the frame that stays with the target
        world[:, 2] -= found.problem.Y_test[:, 3]
    q = np.concatenate([camera.project(world).q for camera in found.cameras], axis=1)
    np.testing.assert_allclose(found.problem.X_test, q, rtol=0, atol=1e-9)


def test_fewer_random_points_are_the_first_of_them() -> None:
    few, many = (arm_problem(_arm(ArmData.VOLUME, points=n), 5).problem for n in (90, 200))
    np.testing.assert_array_equal(few.Y, many.Y[:90])
    np.testing.assert_array_equal(few.Y_test, many.Y_test)


def test_distortion_changes_pixels_and_not_points() -> None:
    plain, bent = (arm_problem(_arm(ArmData.DISTORTED_VOLUME, k1=k1), 1) for k1 in (0.0, -0.1))
    shared = {tuple(p) for p in plain.problem.Y_test.tolist()} & {
        tuple(p) for p in bent.problem.Y_test.tolist()
    }
    assert len(shared) > 0.8 * TESTS  # the same stream; a few leave or enter the picture
    assert np.abs(plain.problem.X[:20] - bent.problem.X[:20]).max() > 1.0


def test_half_way_between_what_was_trained() -> None:
    focal = arm_problem(_arm(ArmData.FOCAL_LENGTHS, tested="between"), 0).problem
    assert set(np.unique(focal.Y[:, 3:])) == {FOCAL_LENGTH_MM, FOCAL_RATIO * FOCAL_LENGTH_MM}
    assert set(np.unique(focal.Y_test[:, 3:])) == {FOCAL_LENGTH_MM * (1 + FOCAL_RATIO) / 2}
    slide = arm_problem(_arm(ArmData.POSITIONS, tested="between"), 0).problem
    assert np.unique(slide.Y[:, 3]).tolist() == [0, 75, 150, 225, 300]
    assert np.unique(slide.Y_test[:, 3]).tolist() == [37.5, 112.5, 187.5, 262.5]


def test_an_oracle_is_as_good_as_least_squares_with_the_known_plane() -> None:
    arm = _arm(ArmData.PLANE, noise=ArmNoise.SPREAD, method=ORACLE)
    found = arm_figures(ArmRun("C3", "limit", arm, 2)).rmse_mm
    data = arm_problem(arm, 2)
    pair = cameras(FOCAL_LENGTH_MM)
    errors = []
    for x, p in zip(data.problem.X_test[:150], data.problem.Y_test[:150], strict=True):

        def beyond(xy: np.ndarray, x: np.ndarray = x, z: float = p[2]) -> np.ndarray:
            point = np.array([[*xy, z]])
            seen = np.concatenate([camera.project(point)[0][0] for camera in pair]) / PIXEL_MM
            return np.asarray((seen - x) / data.sigma_px)

        errors.append(least_squares(beyond, p[:2]).x - p[:2])
    expected = np.sqrt((np.array(errors) ** 2).sum(axis=1).mean())
    assert found == pytest.approx(expected, rel=0.12)  # 150 of the 1000 points: 4 sigma of their scatter


def test_what_an_oracle_cannot_know_is_refused() -> None:
    with pytest.raises(InputError, match="oracle"):
        arm_figures(ArmRun("C5", "x", _arm(ArmData.FOCAL_LENGTHS, method=ORACLE), 0))
    with pytest.raises(InputError, match="pictures"):
        arm_problem(_arm(ArmData.STILL_PICTURES), 0)
    with pytest.raises(InputError, match="130 dots"):
        arm_problem(_arm(ArmData.POSITIONS, points=100), 0)
