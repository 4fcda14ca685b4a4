"""Verdicts on the errors of points and of lengths, rule by rule."""

from dataclasses import replace

import numpy as np
import pytest

from labcal import TruthErrors, examples, load_target, pipeline
from labcal.correspond.points import Points
from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.scored_views import ScoredPart
from labcal.evaluate.verdict.of_length_errors import length_verdict
from labcal.evaluate.verdict.of_truth_errors import truth_verdict
from labcal.evaluate.verdict.verdict import Belief

PART = ScoredPart(200, ("a", "b"), 0)
POINTS = examples.points().where(np.arange(200))
GOOD = TruthErrors(
    n=200, mean_signed_mm=(0.001, 0.0, -0.002), mae_mm=0.09, rmse_mm=0.1, p95_mm=0.2, max_mm=0.3,
    limit_mm=0.095, coverage95=0.95, alignment="none", scored="points of views held out", not_scored=0,
    scored_views=PART, error=np.zeros((200, 3)), points=POINTS,
)  # fmt: skip


def test_good_points_are_believed() -> None:
    verdict = truth_verdict(GOOD)
    assert verdict.belief is Belief.YES
    assert "0.1 mm (RMS; 95% of points within 0.2 mm)" in verdict.expectation
    assert "1.05 times" in verdict.limit


@pytest.mark.parametrize(
    ("change", "belief", "said"),
    [
        ({"scored_views": ScoredPart(0, ("a",), 0)}, Belief.NO, "flagged 'ok'"),
        ({"scored_views": ScoredPart(9, ("a",), 1)}, Belief.NO, "these very views"),
        ({"rmse_mm": 0.31}, Belief.PARTLY, "3.3 times what the noise"),
        ({"mean_signed_mm": (0.07, 0.0, -0.03)}, Belief.PARTLY, "(+0.07, +0, -0.03) mm"),
        ({"coverage95": 0.72}, Belief.PARTLY, "hold only 72%"),
        ({"scored_views": ScoredPart(9, ("a",), None)}, Belief.PARTLY, "not known whether"),
    ],
)
def test_each_doubt_of_points_is_said(change: dict[str, object], belief: Belief, said: str) -> None:
    verdict = truth_verdict(replace(GOOD, **change))
    assert verdict.belief is belief
    assert said in verdict.reasons[0]


def test_without_the_dots_the_limit_is_not_known() -> None:
    verdict = truth_verdict(replace(GOOD, limit_mm=float("nan")))
    assert verdict.belief is Belief.YES
    assert "`detections`" in verdict.advice


def test_what_alignment_hides_is_said() -> None:
    assert not any("rigid motion" in one for one in truth_verdict(GOOD).leaves_out)
    assert any("rigid motion" in one for one in truth_verdict(replace(GOOD, alignment="rigid")).leaves_out)


def lengths(points: Points, calibrated_on: tuple[str, ...] | None) -> LengthErrors:
    errors = pipeline.evaluate(points, examples.TARGET, rig=calibrated_on)
    assert isinstance(errors, LengthErrors)
    return errors


def moved(change: np.ndarray) -> Points:
    points = examples.points()
    return Points(points.view, points.index, points.point + change, points.covariance, points.flag)


def test_lengths_of_new_views_are_believed_and_others_not() -> None:
    points = examples.points()
    assert length_verdict(lengths(points, ("elsewhere",)), 250.0).belief is Belief.YES
    assert length_verdict(lengths(points, points.view.tolist()), 250.0).belief is Belief.NO
    assert length_verdict(lengths(points, None), 250.0).belief is Belief.PARTLY


def test_few_lengths_show_little() -> None:
    points = examples.points()
    few = lengths(points.where([0, 1]), ("elsewhere",))
    verdict = length_verdict(few, float("nan"))
    assert "only 1 length " in verdict.reasons[0]
    assert "unknown" not in verdict.expectation


def test_a_wrong_scale_and_a_single_bad_point_are_told_apart() -> None:
    points = examples.points()
    longest = float(np.ptp(load_target(examples.TARGET).points(), axis=0).max())
    scaled = length_verdict(lengths(moved(1e-3 * points.point), ("elsewhere",)), longest)
    assert scaled.limit == "the scale"
    assert "+1000 ppm" in scaled.reasons[0] or "+99" in scaled.reasons[0]
    bad = np.zeros((len(points), 3))
    bad[5] = [0.0, 0.0, 20.0]
    assert length_verdict(lengths(moved(bad), ("elsewhere",)), longest).limit == "single points"
