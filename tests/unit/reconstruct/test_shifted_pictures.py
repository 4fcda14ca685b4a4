"""Pictures of one camera that have shifted after the calibration, in whatever direction."""

from collections.abc import Callable

import numpy as np
import pytest
from scipy.stats import kstest

from labcal import Detections, Reconstruction, examples, load_target, pipeline
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.calibrate.calibration import Calibration
from labcal.calibrate.systematic_residual import systematic_residual
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches
from labcal.correspond.points import PointFlag
from labcal.report.reconstruct_result import reconstruct_result, reconstruct_words

TARGET = load_target(examples.TARGET)
Change = Callable[[np.ndarray], np.ndarray]


def changed(dots: Detections, change: Change) -> Detections:
    """Return the dots with those of the right camera moved by a function of their pixels, x and y."""
    position = dots.position.copy()
    right = dots.camera == "right"
    position[right] += change(position[right])
    return Detections(
        dots.view, dots.camera, dots.image, dots.size, dots.index, dots.has_id, position, dots.covariance,
        dots.flag,
    )  # fmt: skip


def shift(x: float, y: float) -> Change:
    return lambda q: np.full_like(q, 1.0) * [x, y]


@pytest.fixture(scope="module")
def made() -> Calibration:
    dots = examples.detections()
    return pipeline.calibrate(TARGET, dots, "brown5", hold_out=list(dots.views[1::2]))


@pytest.fixture(scope="module")
def held_out(made: Calibration) -> Detections:
    dots = examples.detections()
    return dots.where(np.isin(dots.view, made.held_out))


def found(made: Calibration, dots: Detections) -> Reconstruction:
    return pipeline.reconstruct(made.rig, dots, TARGET)


def test_views_held_out_raise_no_alarm(made: Calibration, held_out: Detections) -> None:
    good = found(made, held_out)
    assert good.systematic is not None
    assert good.scale is not None
    assert good.systematic.p_value > 0.01
    assert good.scale.p_value > 0.01
    assert good.warnings == ()


@pytest.mark.parametrize(
    "change",
    [shift(0.0, 0.3), lambda q: 1e-3 * (q - [320.0, 240.0]) @ [[0.0, 1.0], [-1.0, 0.0]]],
    ids=["across", "rotation"],
)
def test_changes_across_epipolar_lines_are_noticed_by_residuals(
    made: Calibration, held_out: Detections, change: Change
) -> None:
    off = found(made, changed(held_out, change))
    assert off.check is not None
    assert off.systematic is not None
    assert not off.check.rms_px > 1.0  # far below a pixel
    assert off.systematic.beyond_chance
    assert (off.points.flag == PointFlag.MODEL_MISFIT.value).all()
    result = reconstruct_result("points.csv", made.rig, off)
    assert result.inconsistent is not None
    assert result.inconsistent.views == sorted(held_out.views)


def test_shifts_along_epipolar_lines_are_noticed_by_the_targets_size(
    made: Calibration, held_out: Detections
) -> None:
    off = found(made, changed(held_out, shift(1.5, 0.0)))
    assert off.scale is not None
    assert off.scale.beyond_chance
    assert any("ppm too" in warning for warning in off.warnings)


def test_without_a_target_neither_is_tested(made: Calibration, held_out: Detections) -> None:
    older = made.rig.model_copy(update={"target": None})
    unknown = pipeline.reconstruct(older, held_out)
    assert unknown.systematic is None
    assert unknown.scale is None


def test_the_document_has_ratio_part_and_size(made: Calibration, held_out: Detections) -> None:
    good = found(made, held_out)
    result = reconstruct_result("points.csv", made.rig, good)
    assert good.check is not None
    assert result.residual_ratio == good.check.rms_px / good.check.expected_px
    assert result.systematic == good.systematic
    assert result.target_scale == good.scale
    assert "alike all over the pictures" in reconstruct_words(result)


def test_probabilities_are_uniform_where_cameras_err_as_stated() -> None:
    rng = np.random.default_rng(8)
    plain = examples.rig()
    names = plain.cameras
    sigma = np.array([*([0.3] * 4 + [1e-3, 5e-3, 2e-4, 2e-4, 1e-2]) * 2, *[2e-4] * 3, *[0.05] * 3])
    mix = np.eye(24) + 0.2 * rng.standard_normal((24, 24))
    C = np.outer(sigma, sigma) * (mix @ mix.T)
    p = rng.uniform([20.0, -60.0, 500.0], [120.0, 60.0, 700.0], (60, 3))
    noise = 0.05
    root = np.linalg.cholesky(C)
    true = tuple(plain.camera(name) for name in names)
    layout = Layout(RigState(true, np.eye(4)[None], np.zeros((1, 3))), Freedom(Lenses.FREE, np.zeros((3, 0))))
    values = []
    for _ in range(50):
        cameras = layout.stepped(root @ rng.standard_normal(24), np.zeros((1, 6))).cameras
        q = np.stack([camera.project(p).q for camera in true], axis=1)
        q += noise * rng.standard_normal(q.shape)
        pixels = np.tile(noise**2 * np.eye(2), (len(p), 2, 1, 1))
        matches = Matches(tuple(names), np.full(len(p), "a"), np.zeros((len(p), 2), np.int64), q, pixels)
        point = triangulate(cameras, q, pixels).point
        tested = systematic_residual(cameras, matches, point, C, CalibrationRecord(scatter_px=0.0))
        assert tested is not None
        values.append(tested.p_value)
    assert kstest(values, "uniform").pvalue > 0.01
