"""The verdict on a calibration: every rule once, and calibrations whose outcome is known."""

from dataclasses import fields, replace

import numpy as np
import pytest

from labcal import examples, load_target, pipeline
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.evaluate.verdict.calibration_evidence import calibration_evidence
from labcal.evaluate.verdict.of_calibration import CalibrationEvidence, calibration_verdict
from labcal.evaluate.verdict.verdict import Belief
from labcal.evaluate.working_distance import WorkingDistance, working_distance

AT = WorkingDistance(
    distance_mm=640.0, nearest_mm=500.0, farthest_mm=800.0, sigma_mm=0.083, across_mm=0.04, along_mm=0.06
)
GOOD = CalibrationEvidence(
    at=AT, calibration_mm=0.02, noise_px=0.02, scatter_px=0.004, rms_px=0.028, views=20, held_out=2,
    outliers=0.0, coverage=0.8, baseline_mm=200.0,
)  # fmt: skip


def test_a_good_calibration_is_believed_and_says_how_good() -> None:
    verdict = calibration_verdict(GOOD)
    assert verdict.belief is Belief.YES
    assert "0.085 mm" in verdict.expectation  # the root of 0.083 and 0.02 squared
    assert "640 mm" in verdict.expectation
    assert "noise of the dots, 0.02 px" in verdict.limit
    assert verdict.sentence.startswith("Expect a 3-D error of 0.085 mm")
    assert verdict.sentence.count(".") - verdict.sentence.count("0.") == 1  # one sentence


def test_errors_in_the_frame_of_the_rig_are_told_where_they_are_much_larger() -> None:
    assert "frame" not in calibration_verdict(replace(GOOD, in_frame_mm=0.09)).expectation
    expectation = calibration_verdict(replace(GOOD, in_frame_mm=1.9)).expectation
    assert expectation.startswith("a 3-D error of 0.085 mm")
    assert "1.9 mm in the frame of the rig" in expectation


NAMED = ("left",)


@pytest.mark.parametrize(
    ("change", "belief", "said"),
    [
        ({"causes": ("camera-moved",)}, Belief.NO, "most likely camera-moved"),
        ({"two_lenses": NAMED}, Belief.NO, "two different lenses"),
        ({"finished": False}, Belief.NO, "not come to its end"),
        ({"views": 3}, Belief.PARTLY, "3 views"),
        ({"open_lens": NAMED}, Belief.PARTLY, "border"),
        ({"uneven": NAMED, "scatter_px": 0.4}, Belief.PARTLY, "0.4 px beyond their noise of 0.02 px"),
        ({"undetermined": NAMED}, Belief.PARTLY, "coefficients"),
        ({"outliers": 0.14}, Belief.PARTLY, "14% of the dots"),
        ({"coverage": 0.2}, Belief.PARTLY, "20% of a picture"),
    ],
)
def test_each_doubt_is_said_with_its_reason(change: dict[str, object], belief: Belief, said: str) -> None:
    verdict = calibration_verdict(replace(GOOD, **change))
    assert verdict.belief is belief
    assert said in verdict.reasons[0]
    assert said in verdict.sentence


def test_the_heaviest_doubt_comes_first_and_decides() -> None:
    verdict = calibration_verdict(replace(GOOD, coverage=0.1, views=3, causes=("unsynchronised",)))
    assert verdict.belief is Belief.NO
    assert len(verdict.reasons) == 3
    assert "unsynchronised" in verdict.reasons[0]
    assert "contradiction" in verdict.limit


@pytest.mark.parametrize(
    ("change", "limit"),
    [
        ({"calibration_mm": 0.2}, "20 views determine the cameras"),
        ({"at": replace(AT, along_mm=0.4)}, "depth, at 10 times"),
        ({"scatter_px": 0.05}, "lens model and print"),
    ],
)
def test_the_largest_part_of_the_error_is_its_limit(change: dict[str, object], limit: str) -> None:
    verdict = calibration_verdict(replace(GOOD, **change))
    assert verdict.belief is Belief.YES
    assert limit in verdict.limit


def test_what_the_sigma_leaves_out_is_said_with_its_size() -> None:
    left = " ".join(calibration_verdict(replace(GOOD, calibration_mm=float("nan"))).leaves_out)
    assert "they count as exact" in left
    assert "0.5 mm in 500 mm" in left  # of a pitch that is 0.1% off
    assert "between 500 mm and 800 mm" in left
    assert "they count as exact" not in " ".join(calibration_verdict(GOOD).leaves_out)
    assert "errors of the print" in left
    assert "errors of the print" not in " ".join(calibration_verdict(replace(GOOD, freed=True)).leaves_out)


def test_one_camera_gives_no_depth() -> None:
    at = replace(AT, sigma_mm=float("nan"), along_mm=float("nan"))
    verdict = calibration_verdict(replace(GOOD, at=at))
    assert "no depth" in verdict.expectation
    assert "evaluate" not in verdict.advice  # which needs points


def test_parallel_rays_have_no_working_distance() -> None:
    camera = Camera([[2, 0, 319.5], [0, 2, 239.5], [0, 0, 1]], "telecentric", [0] * 5, np.eye(4), (640, 480))
    at = working_distance([camera], np.array([[0.0, 0.0, 1000.0], [10.0, 0.0, 2000.0]]), [0.1])
    assert at.across_mm == pytest.approx(0.05)  # 0.1 px at 2 px/mm, near and far
    verdict = calibration_verdict(replace(GOOD, at=at, parallel=True))
    assert "distance does not matter" in verdict.expectation


def pair(baseline_mm: float) -> list[Camera]:
    """Two pinhole cameras that look along z."""
    cameras = []
    for x in (0.0, baseline_mm):
        T = np.eye(4)
        T[0, 3] = -x
        cameras.append(
            Camera([[800, 0, 319.5], [0, 800, 239.5], [0, 0, 1]], "pinhole", [0] * 5, T, (640, 480))
        )
    return cameras


def test_precision_is_that_of_the_normal_case_of_stereo() -> None:
    Z, b, f, noise = 1000.0, 150.0, 800.0, 0.1
    at = working_distance(pair(b), np.array([[b / 2, 0.0, Z]]), [noise, noise])
    assert at.distance_mm == pytest.approx(Z)
    # sigma_Z = Z^2 / (b f) sigma_d, where the disparity d has the noise of both pictures.
    assert at.along_mm == pytest.approx(Z**2 / (b * f) * np.sqrt(2) * noise, rel=1e-6)
    # Across, both cameras measure x and y: the mean of two.
    assert at.across_mm == pytest.approx(Z / f * noise / np.sqrt(2), rel=0.01)
    assert at.sigma_mm == pytest.approx(np.hypot(at.along_mm, np.sqrt(2) * at.across_mm), rel=1e-9)


def test_places_that_a_camera_does_not_see_do_not_count() -> None:
    cameras = pair(150.0)
    at = working_distance(cameras, np.array([[75.0, 0.0, 1000.0], [5000.0, 0.0, 1000.0]]), [0.1, 0.1])
    assert at.farthest_mm == pytest.approx(1000.0)
    assert np.isnan(working_distance(cameras, np.array([[5000.0, 0.0, 1000.0]]), [0.1, 0.1]).sigma_mm)


def replace_position(dots: Detections, shift: np.ndarray) -> Detections:
    columns = {f.name: getattr(dots, f.name) for f in fields(Detections)}
    return Detections(**{**columns, "position": dots.position + shift})


@pytest.fixture(scope="module")
def known() -> tuple[CalibrationEvidence, float]:
    """A calibration of the example, and the RMS error of points by it against where their dots were."""
    target = load_target(examples.TARGET)
    made = pipeline.calibrate(target, examples.detections(), "brown5")
    return calibration_evidence(made), made.found.rms_px


def test_the_example_is_good_and_its_noise_is_found(known: tuple[CalibrationEvidence, float]) -> None:
    evidence, rms_px = known
    assert evidence.rms_px == rms_px
    assert evidence.noise_px == pytest.approx(examples.SIGMA_PX, rel=1e-6)
    assert evidence.baseline_mm == pytest.approx(200.0, rel=0.01)
    assert 500.0 < evidence.at.distance_mm < 800.0
    # examples.points() states its own sigma from the true cameras: the root of the trace, median 0.076 mm.
    assert evidence.at.sigma_mm == pytest.approx(float(np.median(examples.points().sigma_mm)), rel=0.15)
    assert calibration_verdict(evidence).belief is Belief.YES


@pytest.mark.slow
def test_a_camera_that_moved_is_not_believed() -> None:
    target, dots = load_target(examples.TARGET), examples.detections()
    after = (dots.camera == "right") & np.isin(dots.view, dots.views[4:])
    moved = replace_position(dots, np.where(after[:, None], [6.0, 2.0], 0.0))
    made = pipeline.calibrate(target, moved, "brown5")
    verdict = calibration_verdict(calibration_evidence(made))
    assert verdict.belief is Belief.NO
    assert "camera-moved" in verdict.sentence


def test_few_views_are_no_good_calibration() -> None:
    target, dots = load_target(examples.TARGET), examples.detections()
    few = pipeline.calibrate(target, dots.where(np.isin(dots.view, dots.views[:4])), "brown-k1k2")
    verdict = calibration_verdict(calibration_evidence(few))
    assert verdict.belief is Belief.PARTLY
    assert "number of views" in verdict.limit
