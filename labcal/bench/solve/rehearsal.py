"""Forecasts of rehearsals against calibrations of the same plans, simulated, and rendered in the full plan.

One calibration tells little: all points share its errors, so that its RMS error may be half or twice the
expected one. RMS errors are therefore over sets, and are compared up to what chance leaves of them.
"""

import numpy as np
from scipy.stats import spearmanr

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.rehearsal_set import RehearsalErrors, RehearsalSet, measured_rehearsal
from labcal.guide.rehearsal.catalogue import load_rig_plan, rig_plan_names
from labcal.guide.rehearsal.dot_noise import drawn_pictures, measured_noise
from labcal.guide.rehearsal.forecast import Forecast, Sources, forecast
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rehearsal import rehearsed
from labcal.guide.rehearsal.rendered_rig import confirmed
from labcal.guide.rehearsal.settings import RehearseSettings
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases
from labcal.run.machine import usable_cores

SETS, QUICK_SETS = 100, 20
"""Of each plan."""
MOST_OFF, LEAST_RANK = 0.15, 0.9
_CHANCE = 2.6
"""Standard errors of an RMS that chance is granted: of a hundred good ones, one is beyond."""
_DRAWN = 4
"""Views of each plan whose pictures are drawn for the noise of dots."""


def rehearsal_findings(bench: Bench) -> Findings:
    """Return how far RMS errors are off the forecast, and how alike the maps of errors are, by plan."""
    plans = [(name, *_forecast(name, bench.seed)) for name in rig_plan_names()]
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cases = [RehearsalSet(name, sources.dots, seed) for name, sources, _ in plans for seed in seeds]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_rehearsal, RehearsalErrors, bench.folder / "rehearsals", executor, bench.progress
        )
    checks: list[Check] = []
    figures: list[Figure] = []
    for number, (name, _, made) in enumerate(plans):
        own = found[number * len(seeds) : (number + 1) * len(seeds)]
        square = np.array([one.square_mm2 for one in own])
        by_set = square.mean(axis=1)
        measured = float(np.sqrt(by_set.mean()))
        chance = _CHANCE * 0.5 * float(by_set.std() / by_set.mean() / np.sqrt(len(by_set)))
        rank = float(spearmanr(square.mean(axis=0), made.point_mm[made.seen]).statistic)
        inside = np.sqrt(by_set)
        covered = float(((inside >= made.lowest_mm) & (inside <= made.highest_mm)).mean())
        title = f"rehearsal of {name}, {len(seeds)} simulated calibrations"
        checks += [
            at_most(f"{title}: RMS error over the forecast, off 1", abs(measured / made.rms_mm - 1.0),
                    MOST_OFF + chance),
            at_most(f"{title}: rank correlation of the error map, below 1", 1.0 - rank, 1.0 - LEAST_RANK),
        ]  # fmt: skip
        figures += [
            Figure(name=f"{title}: RMS error over the forecast", value=measured / made.rms_mm),
            Figure(name=f"{title}: expected RMS error, mm", value=made.rms_mm),
            Figure(name=f"{title}: share of sets within the range of 95%", value=covered),
        ]
    if bench.quick:
        return Findings(checks, figures, ("rehearsals are confirmed by rendering in the full plan only",))
    for name, _, _ in plans:
        check, beside = _rendered(name, bench)
        checks.append(check)
        figures += beside
    return Findings(checks, figures)


def _forecast(name: str, seed: int) -> tuple[Sources, Forecast]:
    planned = PlannedRig.of(load_rig_plan(name))
    plan = planned.plan
    views = planned.views(plan.shoot.views, 0)
    some = views[:: -(-len(views) // _DRAWN)]
    pictures = drawn_pictures(planned.cameras, some, plan.target, plan.photometry, seed)
    sources = Sources.of(plan, measured_noise(pictures))
    return sources, forecast(planned, views, sources)


def _rendered(name: str, bench: Bench) -> tuple[Check, list[Figure]]:
    """Return whether a rendered rig errs as foretold, and the figures of it."""
    folder = bench.folder / f"rendered-{name}"
    folder.mkdir(exist_ok=True)
    settings = RehearseSettings(seed=bench.seed, confirm=True, workers=usable_cores())
    found = confirmed(rehearsed(load_rig_plan(name), bench.seed), folder, settings, bench.progress)
    title = f"rehearsal of {name}, rendered"
    off = abs(found.dot_rms_px / found.dot_expected_px - 1.0)
    return at_most(f"{title}: RMS error of dots over the forecast, off 1", off, MOST_OFF), [
        Figure(name=f"{title}: RMS error over the forecast", value=found.rms_mm / found.expected_mm),
        Figure(name=f"{title}: least of that after one calibration, in 95 of 100",
               value=found.lowest_mm / found.expected_mm),
        Figure(name=f"{title}: greatest of that", value=found.highest_mm / found.expected_mm),
    ]  # fmt: skip
