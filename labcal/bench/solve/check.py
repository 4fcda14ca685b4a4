"""``labcal check`` against simulated changes of known size: false alarms, misses, cameras named."""

from itertools import product

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.check_set import PRINTS, SIZES, UNCHANGED, CheckFigures, CheckSet, measured_checks
from labcal.calibrate.validity.change import ChangeKind
from labcal.report.bench import Figure, at_most
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 4, 1
"""Of each cell."""
VIEWS = (6, 12)
FALSE_ALARMS = 0.02
TELLING_SIGMAS = 3.0
"""Standard deviations of a point that a change costs, from which on none may be missed."""
WRONG_CAMERAS = 0.05
MENDED_SIGMAS = 1.5
"""RMS error of points after the correction, in units of the budget before."""
_CHANCE = 2.6
"""Standard errors of a share that chance is granted."""


def check_findings(bench: Bench) -> Findings:
    """Return false alarms, missed changes, wrongly named cameras, and errors after the correction."""
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cases = [CheckSet(*cell, seed) for cell in product(KINDS, PRINTS, VIEWS) for seed in seeds]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_checks, CheckFigures, bench.folder / "checks", executor, bench.progress
        )
    still = UNCHANGED * len(found)
    alarms = sum(one.alarms for one in found) / still
    granted = FALSE_ALARMS + _CHANCE * np.sqrt(FALSE_ALARMS * (1.0 - FALSE_ALARMS) / still)
    changed = [one for each in found for one in each.changed]
    telling = [one for one in changed if one.cost_sigmas > TELLING_SIGMAS]
    missed = sum(not one.found for one in telling) / max(1, len(telling))
    mended = [one.mended_sigmas for one in changed if one.found and np.isfinite(one.mended_sigmas)]
    checks = [
        at_most(f"check, {still} unchanged rigs: share of false alarms", alarms, float(granted)),
        at_most(f"check, {len(telling)} changes that cost more than 3 sigma: share missed", missed, 0.0),
        at_most(
            f"check, {len(mended)} corrected rigs: RMS error of points over the budget before",
            float(np.sqrt(np.mean(np.square(mended)))),
            MENDED_SIGMAS,
        ),
    ]
    corrected = len(mended) / max(1, sum(one.found for one in changed))
    references = [Figure(name="check, changes found: share that can be corrected", value=corrected)]
    for kind in SIZES:
        of_kind = [one for one in changed if one.kind == kind.value]
        named = [one.named for one in of_kind if one.found and one.named is not None]
        wrong = 1.0 - float(np.mean(named)) if named else 0.0
        if kind is not ChangeKind.SHIFTED:
            name = f"check, {len(named)} rigs with a camera {kind.value}: share of wrong cameras named"
            checks.append(at_most(name, wrong, WRONG_CAMERAS))
        share = float(np.mean([one.found for one in of_kind]))
        references.append(Figure(name=f"check, camera {kind.value}: share found", value=share))
        named_share = len(named) / max(1, sum(one.found for one in of_kind))
        name = (
            f"check, camera {kind.value}: share in which the camera is named (else said not to be determined)"
        )
        references.append(Figure(name=name, value=named_share))
    return Findings(checks, references)
