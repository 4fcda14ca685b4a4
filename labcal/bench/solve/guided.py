"""Guided capture against random poses: views to reach an error, poses that are found, the error stated."""

from dataclasses import dataclass

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.guided_set import (
    RANDOM_VIEWS,
    GuidedFigures,
    GuidedSet,
    measured_guided,
    random_errors,
)
from labcal.guide.rehearsal.catalogue import load_rig_plan
from labcal.guide.rehearsal.dot_noise import drawn_pictures, measured_noise
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases

RIGS = ("webcams", "converging", "narrow")
"""A wide pair of webcams on a desk, cameras that look from both sides, and long lenses."""
QUICK_RIGS = ("webcams",)
SEEDS, QUICK_SEEDS = 20, 3
MOST_VIEWS = 0.6
"""Of the views that random poses need, median of all seeds."""
LEAST_FOUND = 0.95
WITHIN = 0.2
"""Of the error that is stated at the end."""
_DRAWN = 12
"""Views from which the noise of dots is known by their size: from four its power is hardly known."""
_CHANCE = 2.6
"""Standard errors that chance is granted: of a hundred good ones, one is beyond."""


@dataclass(frozen=True)
class _Rig:
    """A rig of the benchmark, and its cases."""

    name: str
    wanted_mm: float
    cases: list[GuidedSet]


def guided_findings(bench: Bench) -> Findings:
    """Return the views that guided captures need, the shares of poses found, and the errors stated."""
    seeds = range(bench.seed, bench.seed + (QUICK_SEEDS if bench.quick else SEEDS))
    rigs = [_rig(name, seeds) for name in (QUICK_RIGS if bench.quick else RIGS)]
    cases = [case for rig in rigs for case in rig.cases]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_guided, GuidedFigures, bench.folder / "guided", executor, bench.progress
        )
    checks: list[Check] = []
    figures: list[Figure] = []
    for number, rig in enumerate(rigs):
        more = _findings(rig, found[number * len(seeds) : (number + 1) * len(seeds)])
        checks += more.checks
        figures += more.references
    return Findings(checks, figures)


def _rig(name: str, seeds: range) -> _Rig:
    planned = PlannedRig.of(load_rig_plan(name))
    plan = planned.plan
    views = planned.views(_DRAWN, 0)
    noise = measured_noise(drawn_pictures(planned.cameras, views, plan.target, plan.photometry, seeds.start))
    many = [random_errors(planned, noise, seed)[RANDOM_VIEWS - 1] for seed in seeds]
    wanted = float(np.median(many))
    return _Rig(name, wanted, [GuidedSet(name, noise, wanted, seed) for seed in seeds])


def _findings(rig: _Rig, found: list[GuidedFigures]) -> Findings:
    title = f"guided capture, {rig.name}, {len(found)} seeds"
    views = float(np.median([one.views for one in found]))
    random = float(np.median([one.random_views for one in found]))
    asked, indexed = (sum(getattr(one, part) for one in found) for part in ("asked", "found"))
    stated, actual, stated_shape, actual_shape = (
        float(np.sqrt(np.mean([getattr(one, part) ** 2 for one in found])))
        for part in ("stated_mm", "actual_mm", "stated_shape_mm", "actual_shape_mm")
    )
    square = np.array([(one.actual_mm / one.stated_mm) ** 2 for one in found])
    chance = 0.5 * _CHANCE * float(square.std(ddof=1)) / np.sqrt(len(square))
    return Findings(
        [
            at_most(f"{title}: views over those of random poses, medians", views / random, MOST_VIEWS),
            at_most(f"{title}: share of {asked} pictures asked for that are not indexed",
                    1.0 - indexed / asked, 1.0 - LEAST_FOUND),
            at_most(f"{title}: RMS 3-D error at the end over the one stated, off 1 (limit: {WITHIN:.0%}, and "
                    f"{chance:.1%} for chance, {_CHANCE:g} standard errors)",
                    abs(actual / stated - 1.0), WITHIN + chance),
            at_most(f"{title}: RMS error of shape at the end over the one stated, off 1 "
                    f"(limit: {WITHIN:.0%})",
                    abs(actual_shape / stated_shape - 1.0), WITHIN),
        ],
        [
            Figure(name=f"{title}: views", value=views),
            Figure(name=f"{title}: random views", value=random),
            Figure(name=f"{title}: error of the calibration asked for, mm", value=rig.wanted_mm),
            Figure(name=f"{title}: RMS 3-D error at the end, mm", value=actual),
            Figure(name=f"{title}: RMS 3-D error at the end over the one stated", value=actual / stated),
            Figure(name=f"{title}: RMS error of shape at the end over the one stated",
                   value=actual_shape / stated_shape),
            Figure(name=f"{title}: share of captures with a 3-D error within {WITHIN:.0%} of the one stated",
                   value=_share_within([one.actual_mm / one.stated_mm for one in found])),
            Figure(name=f"{title}: share of captures with an error of shape within {WITHIN:.0%} of the one "
                        "stated",
                   value=_share_within([one.actual_shape_mm / one.stated_shape_mm for one in found])),
            Figure(name=f"{title}: share of captures that reached the error",
                   value=float(np.mean([one.reached for one in found]))),
        ],
    )  # fmt: skip


def _share_within(ratios: list[float]) -> float:
    return float(np.mean(np.abs(np.array(ratios) - 1.0) <= WITHIN))
