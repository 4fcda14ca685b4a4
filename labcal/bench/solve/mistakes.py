"""Detection of inconsistent pictures by calibration, on rendered sets with and without mistakes."""

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.mistaken_set import SIZES, SetFigures, SetOfPictures, evaluated_set
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 100, 4
MISSED_LIMIT, ACCUSED_LIMIT = 0.05, 0.02


def mistake_findings(bench: Bench) -> Findings:
    """Return the shares of sets with a mistake that are reported, and of good sets that are."""
    count = QUICK_SETS if bench.quick else SETS
    sets = [SetOfPictures(seed) for seed in range(bench.seed, bench.seed + count)]
    with bench.executor(count) as executor:
        found = run_cases(sets, evaluated_set, SetFigures, bench.folder / "sets", executor, bench.progress)
    checks: list[Check] = []
    references: list[Figure] = []
    for mistake, size in SIZES.items():
        judged = [one.mistakes[mistake] for one in found]
        name = f"mistakes, {count} rendered sets, {mistake} of {size:g} times the usual size"
        missed = float(np.mean([not one.told for one in judged]))
        checks.append(at_most(f"{name}: share not told", missed, MISSED_LIMIT))
        named = float(np.mean([one.named for one in judged]))
        references.append(Figure(name=f"{name}: share whose likeliest cause is right", value=named))
        ratios = [one.lengths for one in judged if np.isfinite(one.lengths)]
        if ratios:
            what = f"{name}: errors of lengths over those without it, median"
            references.append(Figure(name=what, value=float(np.median(ratios))))
    accused = float(np.mean([one.accused for one in found]))
    checks.append(
        at_most(f"mistakes, {count} rendered sets without one: share accused", accused, ACCUSED_LIMIT)
    )
    return Findings(checks, references)
