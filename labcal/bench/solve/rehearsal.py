"""Forecasts of rehearsals against calibrations of the same plans: many simulated ones, and rendered ones.

Errors of shape hardly differ from one calibration to the next, and are judged after a single rendered one.
Errors in the frame of the first camera do differ, since all points share those of their calibration: they are
judged over many simulated ones, and over all rendered plans together.
"""

import numpy as np
from scipy.stats import spearmanr

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.rehearsal_set import DRAWS, RehearsalErrors, RehearsalSet, measured_rehearsal
from labcal.guide.rehearsal.catalogue import load_rig_plan, rig_plan_names
from labcal.guide.rehearsal.confirmation import Confirmation, group_rank, lowest_rank
from labcal.guide.rehearsal.dot_noise import drawn_pictures, measured_noise
from labcal.guide.rehearsal.error_scatter import WITHIN
from labcal.guide.rehearsal.forecast import Forecast, forecast
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import rehearsed
from labcal.guide.rehearsal.rendered_rig import confirmed
from labcal.guide.rehearsal.settings import RehearseSettings
from labcal.guide.rehearsal.sources import Sources
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases
from labcal.run.machine import usable_cores

SETS, QUICK_SETS = 40, 8
"""Of each plan, simulated."""
LEAST_RANK = 0.9
"""Of maps; where errors are so much alike all over the volume that chance makes less of a true forecast, that
which it exceeds in 95 of 100."""
QUICK_PLANS = ("webcams",)
"""Plans that a quick run renders."""
_CHANCE = 2.6
"""Standard errors that chance is granted: of a hundred good ones, one is beyond."""
_DRAWN = 4
"""Views of each plan whose pictures are drawn for the noise of dots."""


def rehearsal_findings(bench: Bench) -> Findings:
    """Return how far RMS errors are off the forecast, and how alike the maps of errors are, by plan."""
    plans = [(name, *_forecast(name, bench.seed)) for name in rig_plan_names()]
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cases = [
        RehearsalSet(name, sources.dots, made.dot_places, seed)
        for name, sources, made in plans
        for seed in seeds
    ]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_rehearsal, RehearsalErrors, bench.folder / "rehearsals", executor, bench.progress
        )
    checks: list[Check] = []
    figures: list[Figure] = []
    for number, (name, _, made) in enumerate(plans):
        own = found[number * len(seeds) : (number + 1) * len(seeds)]
        title = f"rehearsal of {name}, {len(seeds)} simulated calibrations"
        more = _simulated(title, made, own)
        checks += more.checks
        figures += more.references
    rendered = QUICK_PLANS if bench.quick else tuple(rig_plan_names())
    confirmations = [_rendered(name, bench) for name in rendered]
    for name, one in zip(rendered, confirmations, strict=True):
        more = _rendered_findings(f"rehearsal of {name}, {one.sets} rendered", one)
        checks += more.checks
        figures += more.references
    checks.append(
        at_most(
            f"rehearsals of {len(rendered)} rendered plans: mean square in the frame of the first camera "
            "over the forecast, off by standard errors",
            _off_by_chance(confirmations),
            _CHANCE,
        )
    )
    return Findings(checks, figures)


def _forecast(name: str, seed: int) -> tuple[Sources, Forecast]:
    planned = PlannedRig.of(load_rig_plan(name))
    plan = planned.plan
    views = planned.views(plan.shoot.views, 0)
    some = views[:: -(-len(views) // _DRAWN)]
    pictures = drawn_pictures(planned.cameras, some, plan.target, plan.photometry, seed)
    sources = Sources.of(plan, measured_noise(pictures))
    return sources, forecast(planned, views, sources)


def _simulated(title: str, made: Forecast, found: list[RehearsalErrors]) -> Findings:
    """Return errors of simulated calibrations over the forecast."""
    square = np.array([one.square_mm2 for one in found])
    shape = np.array([one.shape_mm2 for one in found])
    by_set = square.mean(axis=1)
    places_ratio = float(np.sqrt(by_set.mean())) / made.rms_mm
    shape_ratio = float(np.sqrt(shape.mean())) / made.shape_mm
    # By the foretold scatter: that of so few sets is not well known from themselves.
    low, high = made.places.range_of_mean(len(found))
    chance = 0.5 * _CHANCE / 1.96 * (high - low) / made.rms_mm
    rank = float(spearmanr(square.mean(axis=0), made.point_mm[made.seen]).statistic)
    foretold = (made.noise + made.shape)[made.seen]
    shape_rank = group_rank(shape, np.trace(foretold, axis1=1, axis2=2))
    low_one, high_one = made.places.range_mm
    inside = float(((np.sqrt(by_set) >= low_one) & (np.sqrt(by_set) <= high_one)).mean())
    return Findings(
        [
            at_most(f"{title}: RMS error of shape over the forecast, off 1", abs(shape_ratio - 1.0), WITHIN),
            at_most(f"{title}: RMS error in the frame of the first camera over the forecast, off 1",
                    abs(places_ratio - 1.0), WITHIN + chance),
            at_most(f"{title}: rank correlation of the error map, below 1", 1.0 - rank, 1.0 - LEAST_RANK),
            at_most(f"{title}: rank correlation of the map of shape, below 1", 1.0 - shape_rank,
                    1.0 - min(LEAST_RANK, lowest_rank(foretold, DRAWS * len(found)))),
        ],
        [
            Figure(name=f"{title}: RMS error of shape over the forecast", value=shape_ratio),
            Figure(name=f"{title}: RMS error in the frame of the first camera over the forecast",
                   value=places_ratio),
            Figure(name=f"{title}: expected RMS error, mm", value=made.rms_mm),
            Figure(name=f"{title}: expected RMS error of shape, mm", value=made.shape_mm),
            Figure(name=f"{title}: share of sets within the range of 95%", value=inside),
        ],
    )  # fmt: skip


def _rendered(name: str, bench: Bench) -> Confirmation:
    folder = bench.folder / f"rendered-{name}"
    folder.mkdir(exist_ok=True)
    settings = RehearseSettings(seed=bench.seed, confirm=1, workers=usable_cores())
    return confirmed(rehearsed(load_rig_plan(name), bench.seed), folder, settings, bench.progress)


def _rendered_findings(title: str, found: Confirmation) -> Findings:
    """Return errors of a rendered rig over the forecast."""
    dots = found.dot_rms_px / found.dot_expected_px
    places = found.places
    return Findings(
        [
            at_most(f"{title}: RMS error of shape over the forecast, off 1",
                    abs(found.shape.ratio - 1.0), found.shape.allowed),
            at_most(f"{title}: RMS error of dots over the forecast, off 1", abs(dots - 1.0), WITHIN),
            at_most(f"{title}: rank correlation of the map of shape, below 1", 1.0 - found.map_rank,
                    1.0 - min(LEAST_RANK, found.map_rank_lowest)),
        ],
        [
            Figure(name=f"{title}: RMS error of shape over the forecast", value=found.shape.ratio),
            Figure(name=f"{title}: RMS error of dots over the forecast", value=dots),
            Figure(name=f"{title}: RMS error in the frame of the first camera over the forecast",
                   value=places.ratio),
            Figure(name=f"{title}: least of that by chance, in 95 of 100",
                   value=places.lowest_mm / places.expected_mm),
            Figure(name=f"{title}: greatest of that", value=places.highest_mm / places.expected_mm),
        ],
    )  # fmt: skip


def _off_by_chance(found: list[Confirmation]) -> float:
    """Return by how many standard errors the mean of squared ratios is off 1, all rigs together."""
    ratio = np.array([one.places.ratio**2 for one in found])
    sigma = np.array([one.places.relative_sigma for one in found])
    return float(abs(ratio.mean() - 1.0) / (np.sqrt((sigma**2).sum()) / len(found)))
