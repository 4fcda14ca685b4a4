"""Acceptance test: plan, lengths, decision, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import norm

import labcal
from labcal import (
    InputError,
    LabcalError,
    NamedPixels,
    NamedPoints,
    ReferenceLengths,
    examples,
    plan_lengths,
    read_points,
)
from labcal.evaluate.acceptance.decision import Outcome, Rule, decided
from labcal.evaluate.acceptance.reference_lengths import read_lengths
from labcal.pipeline import CertifySettings
from labcal.rng import generator

SIDES = (400.0, 300.0, 200.0)
SIGMA = 0.01
"""Standard deviation of each coordinate, mm."""


def _points(plan: labcal.LengthPlan, error_mm: float = 0.0, noise: float = 0.0) -> NamedPoints:
    """Return the ends of a plan; the first length is too long by an error."""
    n = len(plan.end_a)
    p = np.concatenate([plan.end_a, plan.end_b])
    p[n] += error_mm * (p[n] - p[0]) / np.linalg.norm(p[n] - p[0])
    p += noise * generator(0, "certify").standard_normal(p.shape)
    views = np.tile(plan.lengths().view_a, 2)
    covariance = np.tile(SIGMA**2 * np.eye(3), (2 * n, 1, 1))
    return NamedPoints(views, np.repeat(["a", "b"], n), p, covariance, np.full(2 * n, "ok"))


def _reference(plan: labcal.LengthPlan, sigma_mm: float = 0.0) -> ReferenceLengths:
    form = plan.lengths()
    return ReferenceLengths(
        form.line, form.length, form.view_a, form.point_a, form.view_b, form.point_b, plan.nominal_mm,
        np.full(35, sigma_mm),
    )  # fmt: skip


def test_a_plan_has_what_the_guideline_asks() -> None:
    plan = plan_lengths(SIDES)
    form = plan.lengths()
    assert len(form) == 35
    assert [int((form.line == line).sum()) for line in dict.fromkeys(form.line)] == [5] * 7
    assert not plan.warnings
    diagonal = np.linalg.norm(SIDES)
    assert form.nominal_mm.max() == pytest.approx(diagonal, abs=1e-3)
    for line in set(form.line):
        assert form.nominal_mm[form.line == line].max() >= min(SIDES)
    ends = np.concatenate([plan.end_a, plan.end_b])
    assert (np.abs(ends) <= 0.5 * np.array(SIDES) + 1e-9).all()
    corners = {tuple(np.sign(end)) for end in ends if np.allclose(np.abs(end), 0.5 * np.array(SIDES))}
    assert len(corners) == 8


def test_a_short_bar_is_said() -> None:
    plan = plan_lengths(SIDES, longest_mm=150.0)
    assert plan.nominal_mm.max() == pytest.approx(150.0)
    assert "less than two thirds" in plan.warnings[0]
    assert "7 lines is shorter than the shortest side" in plan.warnings[1]
    settings = CertifySettings(volume_mm=SIDES)
    assert "less than two thirds" in " ".join(
        labcal.certify(_points(plan), _reference(plan), settings).warnings
    )


@pytest.mark.parametrize(
    ("error", "expected"),
    [
        (0.0, "conforming"),
        (0.08, "conforming"),
        (0.095, "undecided"),
        (0.11, "undecided"),
        (0.14, "not-conforming"),
    ],
)
def test_what_is_stated_is_proven(error: float, expected: str) -> None:
    """Limit 0.1, reference 0.01: guard bands of 1.645 and 2.983 standard uncertainties."""
    plan = plan_lengths(SIDES)
    reference = _reference(plan, 0.01)
    found = labcal.certify(_points(plan, error), reference, CertifySettings(limit_mm=0.1))
    assert found.outcome.value == expected
    assert found.decision.guard_within[0] == pytest.approx(0.01 * norm.isf(0.05))
    assert found.decision.guard_beyond[0] == pytest.approx(0.01 * norm.isf(0.05 / 35))
    simple = labcal.certify(_points(plan, error), reference, CertifySettings(limit_mm=0.1, rule="simple"))
    assert simple.outcome.value == ("conforming" if error <= 0.1 else "not-conforming")
    np.testing.assert_allclose(found.error_mm, [error, *np.zeros(34)], atol=1e-9)


def test_noise_of_the_pixels_widens_the_guard_band_on_request() -> None:
    plan = plan_lengths(SIDES)
    settings = CertifySettings(limit_mm=0.1, uncertainty="noise-and-reference")
    found = labcal.certify(_points(plan, 0.09), _reference(plan, 0.01), settings)
    assert found.decision.guard_within[0] == pytest.approx(norm.isf(0.05) * np.sqrt(0.01**2 + 2 * SIGMA**2))
    assert found.outcome is Outcome.UNDECIDED
    assert labcal.certify(_points(plan, 0.075), _reference(plan, 0.01), settings).outcome is Outcome.UNDECIDED


def test_a_limit_may_grow_with_the_length() -> None:
    plan = plan_lengths(SIDES)
    settings = CertifySettings(limit_mm=0.01, limit_ppm=100.0)
    limits = settings.limits_mm(plan.nominal_mm)
    assert limits[0] == pytest.approx(0.01 + 1e-4 * plan.nominal_mm[0])
    assert labcal.certify(_points(plan, 0.05), _reference(plan), settings).outcome is Outcome.CONFORMING
    assert labcal.certify(_points(plan, 0.07), _reference(plan), settings).outcome is Outcome.NOT_CONFORMING


def test_proven_conformity_is_false_in_one_of_twenty_at_the_limit() -> None:
    """An error of exactly the limit: either is stated in 5%."""
    errors = 1.0 + 0.1 * generator(0, "guard").standard_normal((4000, 1))
    one = [decided(e, np.ones(1), np.full(1, 0.1), Rule.GUARDED, 0.95).whole for e in errors]
    kinds = (Outcome.CONFORMING, Outcome.NOT_CONFORMING)
    for share in [np.mean([outcome is kind for outcome in one]) for kind in kinds]:
        assert abs(share - 0.05) < 3.0 * np.sqrt(0.05 * 0.95 / 4000)
    many = 1.0 + generator(1, "guard").standard_normal((1500, 35)) * 0.1
    whole = [decided(e, np.ones(35), np.full(35, 0.1), Rule.GUARDED, 0.95).whole for e in many]
    wrong = np.mean([outcome is Outcome.NOT_CONFORMING for outcome in whole])
    assert 0.03 < wrong < 0.07  # 35 lengths at the limit: Bonferroni keeps the whole at 5%


def test_too_few_lengths_are_incomplete_but_one_beyond_the_limit_is_enough() -> None:
    plan = plan_lengths(SIDES)
    points, reference = _points(plan, 0.2), _reference(plan)
    few = points.where(points.view != "line-3-length-2")
    found = labcal.certify(few, reference, CertifySettings(limit_mm=0.5))
    assert found.outcome is Outcome.INCOMPLETE
    assert "line-3-length-2" in found.measured.missing[0]
    assert int(found.is_measured.sum()) == 34
    assert labcal.certify(few, reference, CertifySettings(limit_mm=0.1)).outcome is Outcome.NOT_CONFORMING
    assert labcal.certify(few, reference).outcome is Outcome.NO_LIMIT


def test_dots_of_a_target_have_lengths_with_both_shares() -> None:
    """A board of which two dots are 200 mm apart: calibration and noise as `labcal.distance` tells them."""
    target = labcal.load_target(examples.TARGET)
    rig = labcal.pipeline.calibrate(target, examples.detections()).rig
    points = labcal.pipeline.reconstruct(rig, examples.detections(), target)
    reference = ReferenceLengths(["1"], ["1"], ["hand-0"], ["0:0"], ["hand-0"], ["10:0"], [200.0])
    found = labcal.certify(points, reference)
    index, view = points.points.index, points.points.view
    lines = [int(np.flatnonzero((view == "hand-0") & (index == [col, 0]).all(axis=1))[0]) for col in (0, 10)]
    expected = labcal.distance(points, *lines)
    assert found.measured.length_mm[0] == expected.value
    assert found.measured.noise_sigma_mm[0] == expected.noise_sigma
    assert found.measured.calibration_sigma_mm[0] == pytest.approx(expected.calibration_sigma)
    assert abs(found.error_mm[0]) < 4.0 * found.expected_sigma_mm[0]
    with_table = labcal.certify(points.points, reference)
    assert "do not tell noise from errors of the calibration" in " ".join(with_table.warnings)


def test_named_points_of_a_rig_have_both_shares() -> None:
    rig = labcal.pipeline.calibrate(examples.TARGET, examples.detections()).rig
    found = labcal.certify(examples.pixels(), examples.lengths(), rig=rig)
    measured = labcal.measure(rig, examples.pixels())
    expected = labcal.distance(measured, "origin", "right-corner")
    assert found.measured.noise_sigma_mm[0] == expected.noise_sigma
    assert found.measured.calibration_sigma_mm[0] == pytest.approx(expected.calibration_sigma)
    assert (np.abs(found.error_mm) < 4.0 * found.expected_sigma_mm).all()


def test_lengths_read_back_and_may_leave_the_uncertainty_out(tmp_path: Path) -> None:
    examples.lengths().save(tmp_path / "lengths.csv")
    text = (tmp_path / "lengths.csv").read_text(encoding="utf-8")
    lines = [line.rsplit(",", 1)[0] for line in text.splitlines()]
    (tmp_path / "short.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    assert not read_lengths(tmp_path / "short.csv").sigma_mm.any()
    (tmp_path / "empty.csv").write_text(text.replace(",0.002", ","), encoding="utf-8")
    assert read_lengths(tmp_path / "empty.csv") == read_lengths(tmp_path / "short.csv")


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (("100.0", "-1"), "positive"),
        (("100.0", "nan"), "positive"),
        (("100.0", "x"), "no number"),
        (("0.002", "1e9"), "standard uncertainty"),
        (("right-corner", "origin"), "same point"),
        (("1,2,", "1,1,"), "twice"),
        (("point_b", "end"), "line"),
    ],
)
def test_damaged_lengths_are_refused_with_a_reason(
    tmp_path: Path, change: tuple[str, str], message: str
) -> None:
    examples.lengths().save(tmp_path / "lengths.csv")
    text = (tmp_path / "lengths.csv").read_text(encoding="utf-8")
    assert change[0] in text
    (tmp_path / "bad.csv").write_text(text.replace(*change, 1), encoding="utf-8")
    with pytest.raises(InputError, match=message) as refused:
        read_lengths(tmp_path / "bad.csv")
    assert "bad.csv" in str(refused.value)


@pytest.mark.parametrize(
    ("settings", "message"),
    [
        ({"limit_mm": 0.0}, "both 0"),
        ({"limit_mm": -1.0}, "limit_mm"),
        ({"limit_ppm": 10.0}, "Give `limit_mm`"),
        ({"confidence": 1.0}, "confidence"),
        ({"rule": "mine"}, "mine"),
        ({"uncertainty": "none"}, "none"),
        ({"date": "yesterday"}, "2026-11-26"),
        ({"operator": "two\nlines"}, "operator"),
        ({"temperature_c": -300.0}, "temperature_c"),
        ({"volume_mm": [1.0, 2.0]}, "volume_mm"),
        ({"volume_mm": [1.0, 2.0, 0.0]}, "volume_mm"),
        ({"limit_mm": float("nan")}, "limit_mm"),
    ],
)
def test_settings_without_sense_are_refused(settings: dict[str, object], message: str) -> None:
    with pytest.raises(LabcalError, match=message):
        CertifySettings(**settings)


def test_pixels_need_a_rig_and_lengths_their_points() -> None:
    with pytest.raises(InputError, match="Give `rig`"):
        labcal.certify(examples.pixels(), examples.lengths())
    with pytest.raises(InputError, match="Not one of 35 lengths was measured"):
        labcal.certify(examples.pixels(), plan_lengths(SIDES).lengths(), rig=examples.rig())
    for wrong in ([0.0, 1.0, 1.0], [1.0, 2.0]):
        with pytest.raises(InputError, match="volume_mm"):
            plan_lengths(wrong)
    with pytest.raises(InputError, match="longest_mm"):
        plan_lengths(SIDES, longest_mm=-1.0)
    pixels = examples.pixels()
    bare = NamedPixels(pixels.view, pixels.camera, pixels.point, pixels.position)
    found = labcal.certify(bare, examples.lengths(), CertifySettings(pixel_sigma=0.02), rig=examples.rig())
    np.testing.assert_allclose(
        found.error_mm, labcal.certify(pixels, examples.lengths(), rig=examples.rig()).error_mm
    )


def test_points_are_read_from_either_table(tmp_path: Path) -> None:
    found = labcal.measure(examples.rig(), examples.pixels())
    found.save(tmp_path / "named.csv")
    examples.points().save(tmp_path / "dots.csv")
    reference = ReferenceLengths(["1"], ["1"], ["hand-0"], ["0:0"], ["hand-0"], ["10:0"], [200.0])
    named = labcal.certify(tmp_path / "named.csv", examples.lengths())
    np.testing.assert_array_equal(named.error_mm, labcal.certify(found.points, examples.lengths()).error_mm)
    dots = labcal.certify(tmp_path / "dots.csv", reference)
    np.testing.assert_array_equal(
        dots.error_mm, labcal.certify(read_points(tmp_path / "dots.csv"), reference).error_mm
    )
