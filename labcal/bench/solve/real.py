"""Rigs calibrated from pictures from outside this project, if they are available."""

import os
from pathlib import Path

import numpy as np

from labcal.bench.detect.real import PAIR, VARIABLE
from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.bootstrap import SAMPLES, BootstrapScatter
from labcal.bench.solve.half_points import HalfDifference, point_differences
from labcal.bench.solve.halves import (
    disagreement,
    halves,
    lengths_elsewhere,
    print_and_rig,
    squared_differences,
)
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.calibrate.lens_candidates import DEFAULT_LENS
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.measure import detections_of, measure_picture
from labcal.correspond.sources import find_sources
from labcal.distributions import chi2_quantile
from labcal.estimators.fitting import fit_method
from labcal.estimators.handheld_training import handheld_training
from labcal.estimators.model import Model
from labcal.estimators.registry import make_estimator
from labcal.report.bench import Check, Figure, at_most
from labcal.run.progress import Progress
from labcal.targets.catalogue import AnyTarget, load_target

LENS = "brown-k1k2"
RENDERED, RENDERED_TARGET, RENDERED_PICTURES = "rendered_black", "rings-14x10", 20
PHOTOS, PHOTO_TARGET, PHOTO_PICTURES = "photos", "rings-10x8", 14
METHODS_COMPARED = ("hybrid", "mlp", "mlp-bayes", "ray-net")
"""Methods that learn from the dots of a target in the hand."""
AGREE_LIMIT = 3.0
"""Standard deviations."""
LENGTH_LIMIT_MM = 0.010
SCATTER_FACTOR = 1.3
"""Between the scatter of samples of views and the one that stated sigmas imply, either way."""
CONFIDENCE = 0.995
"""Upper end of the interval that holds 99% of chi-square."""


def real_findings(bench: Bench) -> Findings:
    """Return the agreement of two halves of rendered views, and the repeatability of lengths on photographs.

    On the photographs the rig, what methods learned in its world, and the places of the dots come from one
    half of the views, the lengths from the other half. Nothing but a note where the pictures are not at hand.
    """
    home = os.environ.get(VARIABLE)
    if home is None or not Path(home).is_dir():
        return Findings([], [], (f"real: left out, since ${VARIABLE} names no folder of pictures",))
    bench.progress.start("real pictures", RENDERED_PICTURES + PHOTO_PICTURES)
    target = load_target(RENDERED_TARGET)
    dots = _measured(Path(home) / RENDERED, target, bench.progress)
    one, other = (calibrate_handheld(half, target, LENS) for half in halves(dots))
    apart = disagreement(one, other)
    worst = float(np.abs(apart).max())
    checks = [
        at_most(f"{RENDERED}: two halves of the views, largest difference in sigma", worst, AGREE_LIMIT)
    ]
    references = [
        Figure(
            name=f"{RENDERED}: root mean square of its {len(apart)} differences in sigma",
            value=float(np.sqrt((apart**2).mean())),
        )
    ]
    checks.append(_of_chance(f"{RENDERED}, {LENS}", one, other))
    one, other = (calibrate_handheld(half, target, DEFAULT_LENS) for half in halves(dots))
    checks += _budgets_hold(RENDERED, one, other, references)
    checks += _scatter_checks(dots, target, bench.seed)
    target = load_target(PHOTO_TARGET)
    dots = _measured(Path(home) / PHOTOS, target, bench.progress)
    for learned, others, which in zip(halves(dots), halves(dots)[::-1], ("even", "odd"), strict=True):
        found, places = print_and_rig(learned, target, LENS)
        training = handheld_training(found, learned, target).data
        models: dict[str, Rig | Model] = {"rig": found.rig}
        models |= {method: fit_method(training, make_estimator(method)) for method in METHODS_COMPARED}
        for name, model in models.items():
            lengths = lengths_elsewhere(model, places, others, target).length_error_mm
            what = f"{PHOTOS}: lengths in other views, freed dots and {name} of the {which} ones"
            checks.append(at_most(f"{what}, RMS, mm", lengths.rms, LENGTH_LIMIT_MM))
            references.append(Figure(name=f"{what}, largest, mm", value=lengths.max))
    freed = HandheldSettings(dot_places=DotTreatment.FREED)
    of_photos = [calibrate_handheld(half, target, DEFAULT_LENS, freed) for half in halves(dots)]
    checks += _budgets_hold(f"{PHOTOS}, freed dots", of_photos[0], of_photos[1], references)
    return Findings(checks, references)


def _budgets_hold(
    name: str, one: HandheldCalibration, other: HandheldCalibration, references: list[Figure]
) -> list[Check]:
    """Return the checks that points, lengths and parameters of two halves of the views agree.

    Adds how far points and lengths lie apart to the references.
    """
    points, lengths = point_differences(one, other)
    checks = []
    for what, found in (("points", points), ("lengths", lengths)):
        checks.append(_of_differences(f"{name}: {what} of two halves of the views", found))
        apart = f"{name}: {what} of two halves of the views, RMS difference"
        references.append(Figure(name=f"{apart}, mm", value=found.rms_mm))
        references.append(Figure(name=f"{apart} by both budgets, mm", value=found.expected_mm))
    return [*checks, _of_chance(name, one, other)]


def _of_differences(name: str, found: HalfDifference) -> Check:
    """Return the check that differences are no larger than both budgets explain."""
    freedom = found.freedom
    what = f"{name}, squared differences per degree of freedom, of {freedom}"
    return at_most(what, found.squares / freedom, chi2_quantile(CONFIDENCE, freedom) / freedom)


def _scatter_checks(dots: Detections, target: AnyTarget, seed: int) -> list[Check]:
    """Return the checks that stated sigmas are those by which samples of views scatter."""
    found = BootstrapScatter.of(dots, target, DEFAULT_LENS, seed)
    ratios = {"focal lengths": found.focal, "principal points": found.middle, "baseline": found.baseline}
    return [
        at_most(
            f"{RENDERED}: scatter of {what} over {SAMPLES} samples of half of the views, "
            "over stated sigmas, either way",
            float(max(ratio, 1.0 / ratio)),
            SCATTER_FACTOR,
        )
        for what, ratio in ratios.items()
    ]


def _of_chance(name: str, one: HandheldCalibration, other: HandheldCalibration) -> Check:
    """Return the check that two halves of the views differ by no more than their budgets explain."""
    squares, freedom = squared_differences(one, other)
    what = f"{name}: squared differences of two halves of the views, per degree of freedom"
    return at_most(what, squares / freedom, chi2_quantile(CONFIDENCE, freedom) / freedom)


def _measured(folder: Path, target: AnyTarget, progress: Progress) -> Detections:
    """Return the dots of all pictures of a set."""
    measurements = []
    for source in find_sources([str(folder)], PAIR):
        measurements.append(measure_picture(source, target))
        progress.advance()
    return detections_of(measurements)
