"""Dots are freed by themselves where that makes points more certain, and are kept on an even print."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import BudgetSet, simulated_dots
from labcal.calibrate import calibrated as complete
from labcal.calibrate import lens_choice
from labcal.calibrate.dot_decision import MIN_VIEWS, UNEVEN
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.held_out_dots import HeldOutDots
from labcal.correspond.detections import Detections
from labcal.rng import generator

NARROW = KINDS["narrow"]
TIMES = 4.0
"""The print's errors over those of the benchmark, where they are about what the dots' noise is."""


def dots_of(surface: str, views: int = 6) -> Detections:
    kind = replace(NARROW, print_mm=TIMES * NARROW.print_mm)
    case = BudgetSet("narrow", surface, views, "brown5", 3)
    return simulated_dots(kind, case, generator(3, "dot decision", surface))


def calibrated(dots: Detections, **how: object) -> HandheldCalibration:
    settings = HandheldSettings(eccentricity_rounds=0, **how)  # type: ignore[arg-type]
    return calibrate_handheld(dots, NARROW.target(), "brown5", settings)


@pytest.fixture(scope="module")
def uneven() -> Detections:
    return dots_of("uneven")


@pytest.fixture(scope="module")
def freed(uneven: Detections) -> HandheldCalibration:
    return calibrated(uneven)


def test_dots_of_an_uneven_print_are_freed(freed: HandheldCalibration, uneven: Detections) -> None:
    found = freed.dot_decision
    assert (found.asked, found.treatment) == (DotTreatment.AUTO, DotTreatment.FREED)
    assert found.unevenness is not None
    assert found.unevenness > 10 * UNEVEN
    assert found.variance_ratio is not None
    assert found.variance_ratio < 0.5
    assert found.freed_px is not None
    assert found.declared_px is not None
    assert found.freed_px < 0.75 * found.declared_px
    assert "the print is uneven" in found.why
    assert freed.rig.calibration is not None
    assert freed.rig.calibration.dot_places == "freed"
    # The same bytes as on request.
    asked = calibrated(uneven, dot_places="freed")
    assert asked.dot_decision.why == "freed, as asked"
    assert asked.rig.model_dump_json() == freed.rig.model_dump_json()


def test_points_are_nearer_to_the_truth_so(freed: HandheldCalibration, uneven: Detections) -> None:
    focal = {
        name: abs(found.rig.camera("left").K[0, 0] - NARROW.cameras()[0].K[0, 0])
        for name, found in (("freed", freed), ("kept", calibrated(uneven, dot_places="declared")))
    }
    assert focal["freed"] < focal["kept"]


def test_an_even_print_is_kept_with_the_same_bytes() -> None:
    dots = dots_of("even")
    found, named = calibrated(dots), calibrated(dots, dot_places="declared")
    assert found.dot_decision.treatment is DotTreatment.DECLARED
    assert found.dot_decision.why == "as declared: the residuals show no uneven print"
    assert found.dot_decision.variance_ratio is None  # nothing else was computed
    assert found.freed is None
    assert found.rig.model_dump_json() == named.rig.model_dump_json()


def test_few_views_free_nothing(uneven: Detections) -> None:
    few = uneven.where(np.isin(uneven.view, uneven.views[: MIN_VIEWS - 1]))
    found = calibrated(few)
    assert found.freed is None
    assert found.dot_decision.why.startswith("as declared: 4 views of a camera are too few to judge by")


def test_kept_lenses_keep_the_dots(uneven: Detections, freed: HandheldCalibration) -> None:
    found = calibrated(uneven, lenses="fixed", start=freed.rig)
    assert found.dot_decision.why == "as declared: the lenses are kept"


@pytest.mark.slow
def test_a_lens_is_chosen_with_the_dots_treated_as_they_will_be(
    uneven: Detections, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(lens_choice, "OF_VIEWS", ("pinhole", "brown5"))
    made = complete.calibrated(uneven, NARROW.target(), "auto", HandheldSettings(eccentricity_rounds=0))
    assert made.found.dot_decision.frees
    assert made.choice is not None
    # Both lenses predict held-out views to the noise of the dots, which the uneven print is far beyond.
    tried = {trial.lens: trial.held_out_px for trial in made.choice.trials}
    assert tried["brown5"] < 0.8 * (made.found.dot_decision.declared_px or 0.0)


def test_an_advantage_by_chance_is_none() -> None:
    random = np.random.default_rng(5)
    views = tuple(f"view-{number}" for number in range(8))
    below = 0
    for _ in range(400):
        squares = np.exp(0.3 * random.standard_normal((2, 8)))
        below += HeldOutDots(views, squares[0], squares[1]).chance < 0.05
    assert abs(below / 400 - 0.05) < 3 * np.sqrt(0.05 * 0.95 / 400)
    assert HeldOutDots(views, np.full(8, 2.0), 1.0 + 0.1 * random.random(8)).chance < 1e-4
    # Two cameras of the same views are not twice the evidence.
    once = HeldOutDots(views, np.exp(0.3 * random.standard_normal(8)), np.full(8, 0.9))
    assert HeldOutDots.joined([once, once]).chance == pytest.approx(once.chance)
