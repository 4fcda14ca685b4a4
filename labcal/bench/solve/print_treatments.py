"""The treatment of the dots that a calibration chooses by itself, of even and of uneven prints."""

from dataclasses import dataclass, replace

from pydantic import BaseModel, ConfigDict

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import PRINTS, BudgetSet, simulated_dots
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.report.bench import Figure, at_most
from labcal.report.values import Measured
from labcal.rng import generator
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 20, 2
"""Of each kind of pair, print and number of views."""
VIEWS = {PRINTS[0]: (6, 12), PRINTS[1]: (12,)}
"""By print; six views of an uneven one may be too few to tell."""
TIMES = 3.0
"""Errors of uneven prints over those of the benchmark of the budget, which are about what noise is."""
MOST_FREED, MOST_KEPT = 0.02, 0.1


@dataclass(frozen=True)
class PrintSet:
    """A case: kind of pair, print, number of views."""

    case: BudgetSet

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"treatment-{self.case.key}"


class Treatment(BaseModel):
    """The treatment that a calibration chose."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    freed: bool
    unevenness: Measured
    """Standard normal deviate of the score test."""


def treated(one: PrintSet) -> Treatment:
    """Simulate a set and calibrate it with default settings."""
    case, kind = one.case, KINDS[one.case.kind]
    kind = replace(kind, print_mm=TIMES * kind.print_mm)
    random = generator(case.seed, "bench solve", "treatment", case.kind, case.surface, str(case.views))
    dots = simulated_dots(kind, case, random)
    found = calibrate_handheld(dots, kind.target(), case.lens, HandheldSettings(eccentricity_rounds=0))
    return Treatment(freed=found.dot_decision.frees, unevenness=found.dot_decision.unevenness or 0.0)


def treatment_findings(bench: Bench) -> Findings:
    """Return the shares of even prints that are freed, and of uneven ones that are not."""
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cases = [
        PrintSet(BudgetSet(kind, surface, views, "brown5", seed))
        for surface, counts in VIEWS.items()
        for kind in KINDS
        for views in counts
        for seed in seeds
    ]
    with bench.executor(len(cases)) as executor:
        found = run_cases(cases, treated, Treatment, bench.folder / "treatments", executor, bench.progress)
    pairs = list(zip(cases, found, strict=True))
    even = [result.freed for one, result in pairs if one.case.surface == PRINTS[0]]
    uneven = [not result.freed for one, result in pairs if one.case.surface == PRINTS[1]]
    checks = [
        at_most(f"budget, {len(even)} even prints: share freed", sum(even) / len(even), MOST_FREED),
        at_most(f"budget, {len(uneven)} uneven prints: share kept", sum(uneven) / len(uneven), MOST_KEPT),
    ]
    largest = max(result.unevenness for one, result in pairs if one.case.surface == PRINTS[0])
    return Findings(checks, [Figure(name="budget, even prints: largest score", value=largest)])
