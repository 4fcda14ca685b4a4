"""Named points are flagged by size of residuals and by chance: good ones are not, shifted ones are."""

import numpy as np
import pytest
from scipy.stats import kstest

from labcal import NamedPixels, Rig, examples, pipeline
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.residual_level import p_value
from labcal.calibrate.residual_parts import ResidualParts
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.rig_covariance import RigCovariance
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches
from labcal.reconstruct.named_reconstruction import NamedReconstruction

NOISE_PX = 0.05
NAMES = tuple(examples.rig().cameras)
TRUE = tuple(examples.rig().camera(name) for name in NAMES)


def covariance(times: float, rng: np.random.Generator) -> np.ndarray:
    sigma = times * np.array([*([0.3] * 4 + [1e-3, 5e-3, 2e-4, 2e-4, 1e-2]) * 2, *[2e-4] * 3, *[0.05] * 3])
    mix = np.eye(24) + 0.2 * rng.standard_normal((24, 24))
    return np.asarray(np.outer(sigma, sigma) * (mix @ mix.T))


def calibrated(C: np.ndarray, rng: np.random.Generator) -> tuple[Camera, ...]:
    """Return the cameras of a calibration that errs as it states."""
    lenses = Freedom(Lenses.FREE, np.zeros((3, 0)))
    layout = Layout(RigState(TRUE, np.eye(4)[None], np.zeros((1, 3))), lenses)
    step = np.linalg.cholesky(C) @ rng.standard_normal(24)
    return tuple(layout.stepped(step, np.zeros((1, 6))).cameras)


def imaged(n: int, rng: np.random.Generator) -> np.ndarray:
    p = rng.uniform([20.0, -60.0, 500.0], [120.0, 60.0, 700.0], (n, 3))
    q = np.stack([camera.project(p).q for camera in TRUE])
    return np.asarray(q + NOISE_PX * rng.standard_normal(q.shape))


def measured(n: int, times: float, seed: int, shift: tuple[float, float] = (0.0, 0.0)) -> NamedReconstruction:
    """Measure points with a rig whose calibration errs, the right camera's pictures shifted after it."""
    rng = np.random.default_rng(seed)
    C = covariance(times, rng)
    lower = tuple(tuple(row[: number + 1].tolist()) for number, row in enumerate(C))
    known = {
        "covariance": RigCovariance(parameters=tuple(f"p{i}" for i in range(24)), lower=lower),
        "calibration": CalibrationRecord(scatter_px=0.0),
    }
    rig = Rig.of(dict(zip(NAMES, calibrated(C, rng), strict=True))).model_copy(update=known)
    q = imaged(n, rng)
    q[1] += shift
    pixels = NamedPixels(
        np.full(2 * n, "v"),
        np.repeat(NAMES, n),
        np.tile([f"m{i}" for i in range(n)], 2),
        q.reshape(-1, 2),
        np.tile(NOISE_PX**2 * np.eye(2), (2 * n, 1, 1)),
    )
    return pipeline.measure(rig, pixels)


@pytest.mark.parametrize("n", [1, 3, 20])
@pytest.mark.parametrize("times", [0.02, 1.0], ids=["good calibration", "poor calibration"])
def test_good_points_are_not_flagged(n: int, times: float) -> None:
    """At a level of one in ten thousand, forty sets raise an alarm in four tests of a thousand."""
    for seed in range(40):
        found = measured(n, times, seed)
        assert (found.points.flag == "ok").all(), seed
        assert found.warnings == ()


@pytest.mark.parametrize("n", [1, 3, 20])
def test_pictures_shifted_by_five_pixels_are_told(n: int) -> None:
    for seed in range(10):
        found = measured(n, 0.02, seed, (3.0, 4.0))
        assert (found.points.flag == "model-misfit").all()
        assert any("model-misfit" in warning for warning in found.warnings)


def test_small_shifts_of_whole_pictures_are_told_by_what_residuals_have_in_common() -> None:
    found = measured(400, 0.005, 3, (0.0, 0.05))
    assert found.check is not None
    assert not found.check.inconsistent
    assert found.systematic is not None
    assert found.systematic.beyond_chance
    assert (found.points.flag == "model-misfit").all()
    assert "alike all over the pictures" in found.warnings[0]


def test_one_pixel_that_is_off_does_not_flag_the_other_points() -> None:
    rng = np.random.default_rng(2)
    q = imaged(5, rng)
    q[1, 2, 1] += 4.0
    rig = Rig.of(dict(zip(NAMES, TRUE, strict=True)))
    known = rig.model_copy(update={"calibration": CalibrationRecord(scatter_px=0.0)})
    names = np.tile([f"m{i}" for i in range(5)], 2)
    pixels = NamedPixels(
        np.full(10, "v"), np.repeat(NAMES, 5), names, q.reshape(-1, 2),
        np.tile(NOISE_PX**2 * np.eye(2), (10, 1, 1)),
    )  # fmt: skip
    assert pipeline.measure(known, pixels).points.flag.tolist() == ["ok", "ok", "model-misfit", "ok", "ok"]


def test_a_camera_that_is_noisier_by_its_own_word_is_no_contradiction() -> None:
    rng = np.random.default_rng(7)
    q = imaged(200, rng)
    sigma = np.repeat([0.02, 1.0], 200)
    pixels = NamedPixels(
        np.full(400, "v"),
        np.repeat(NAMES, 200),
        np.tile([f"m{i}" for i in range(200)], 2),
        q.reshape(-1, 2) + np.where(sigma == 1.0, 1.0, 0.0)[:, None] * rng.standard_normal((400, 2)),
        (sigma**2 + NOISE_PX**2)[:, None, None] * np.eye(2),
    )
    rig = Rig.of(dict(zip(NAMES, TRUE, strict=True)))
    known = rig.model_copy(update={"calibration": CalibrationRecord(scatter_px=0.0)})
    assert (pipeline.measure(known, pixels).points.flag == "ok").all()


def test_probabilities_of_residuals_are_uniform_where_cameras_err_as_stated() -> None:
    rng = np.random.default_rng(11)
    C = covariance(0.3, rng)
    values = []
    for _ in range(100):
        cameras, q = calibrated(C, rng), imaged(15, rng).transpose(1, 0, 2)
        noise = np.tile(NOISE_PX**2 * np.eye(2), (15, 2, 1, 1))
        matches = Matches(
            NAMES, np.full(15, "a"), np.zeros((15, 2), np.int64), np.ascontiguousarray(q), noise
        )
        point = triangulate(cameras, matches.q, noise).point
        values.append(p_value([ResidualParts.of(cameras, (0, 1), matches, point, 0.0)], C))
    assert kstest(values, "uniform").pvalue > 0.01
