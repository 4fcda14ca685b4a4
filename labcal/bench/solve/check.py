"""``labcal check`` against simulated changes of known size: false alarms, misses, cameras named."""

from collections.abc import Sequence
from itertools import product

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.check_drawn import DrawnSet, measured_drawn
from labcal.bench.solve.check_marks import MarkSet, measured_mark_checks
from labcal.bench.solve.check_set import PRINTS, SIZES, CheckFigures, CheckSet, measured_checks
from labcal.calibrate.validity.change import ChangeKind
from labcal.report.bench import Figure, at_most
from labcal.run.cases import run_cases
from labcal.wording import listed

SETS, MORE_SETS, QUICK_SETS = 4, 7, 1
"""Of each cell; of each kind of pair in drawn pictures and with fixed marks."""
QUICK_KINDS = ("webcam",)
VIEWS = (6, 12)
FALSE_ALARMS = 0.02
TELLING_SIGMAS = 3.0
"""Standard deviations of a point that a change costs, from which on none may be missed."""
WRONG_CAMERAS = 0.05
MENDED_SIGMAS = 1.5
"""RMS error of points after the correction, in units of the budget before."""
_NAMED_BY_MARKS = (ChangeKind.TURNED, ChangeKind.SHIFTED, ChangeKind.REFOCUSED)
_NAMED_BY_A_TARGET = (ChangeKind.TURNED, ChangeKind.REFOCUSED)
"""Between two cameras, a target in the hand does not determine which one was shifted."""
_CHANCE = 2.6
"""Standard errors of a share that chance is granted."""


def check_findings(bench: Bench) -> Findings:
    """Return false alarms, missed changes, wrongly named cameras, and errors after the correction."""
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    more = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else MORE_SETS))
    pairs = QUICK_KINDS if bench.quick else KINDS
    held = [CheckSet(*cell, seed) for cell in product(KINDS, PRINTS, VIEWS) for seed in seeds]
    drawn = [DrawnSet(kind, seed) for kind in pairs for seed in more]
    marks = [MarkSet(kind, seed) for kind in pairs for seed in more]
    with bench.executor(len(held) + len(drawn) + len(marks)) as executor:
        where = (CheckFigures, bench.folder / "checks", executor, bench.progress)
        found = {
            "simulated": run_cases(held, measured_checks, *where),
            "drawn": run_cases(drawn, measured_drawn, *where),
            "fixed marks": run_cases(marks, measured_mark_checks, *where),
        }
    checks, references = [], []
    for name, figures in found.items():
        by_marks = name == "fixed marks"
        both = _findings(f"check, {name}", figures, _NAMED_BY_MARKS if by_marks else _NAMED_BY_A_TARGET)
        checks += both.checks
        references += both.references
    return Findings(checks, references)


def _findings(name: str, found: Sequence[CheckFigures], kinds: tuple[ChangeKind, ...]) -> Findings:
    """Return the checks of one way to check.

    Parameters
    ----------
    name : str
    found : sequence of CheckFigures
    kinds : tuple of ChangeKind
        Kinds of changes whose camera the pictures determine.
    """
    still = sum(one.unchanged for one in found)
    alarms = sum(one.alarms for one in found) / still
    granted = FALSE_ALARMS + _CHANCE * np.sqrt(FALSE_ALARMS * (1.0 - FALSE_ALARMS) / still)
    changed = [one for each in found for one in each.changed]
    telling = [one for one in changed if one.cost_sigmas > TELLING_SIGMAS]
    missed = sum(not one.found for one in telling) / max(1, len(telling))
    mended = [one.mended_sigmas for one in changed if one.found and np.isfinite(one.mended_sigmas)]
    to_name = [one for one in telling if one.kind in kinds]
    unnamed = sum(one.named is not True for one in to_name) / max(1, len(to_name))
    named = [one.named for one in changed if one.found and one.named is not None]
    wrong = float(np.mean(np.logical_not(named))) if named else 0.0
    words = listed([kind.value for kind in kinds])
    checks = [
        at_most(f"{name}, {still} unchanged rigs: share of false alarms", alarms, float(granted)),
        at_most(f"{name}, {len(telling)} changes that cost more than 3 sigma: share missed", missed, 0.0),
        at_most(f"{name}, {len(named)} cameras named: share of wrong ones", wrong, WRONG_CAMERAS),
        at_most(
            f"{name}, {len(to_name)} of these, camera {words}: share not named",
            unnamed,
            WRONG_CAMERAS,
        ),
        at_most(
            f"{name}, {len(mended)} corrected rigs: RMS error of points over the budget before",
            float(np.sqrt(np.mean(np.square(mended)))) if mended else 0.0,
            MENDED_SIGMAS,
        ),
    ]
    corrected = len(mended) / max(1, sum(one.found for one in changed))
    references = [Figure(name=f"{name}, changes found: share that can be corrected", value=corrected)]
    for kind in SIZES:
        of_kind = [one for one in changed if one.kind == kind.value]
        share = float(np.mean([one.found for one in of_kind]))
        references.append(Figure(name=f"{name}, camera {kind.value}: share found", value=share))
        named_share = sum(one.named is not None for one in of_kind if one.found)
        references.append(
            Figure(
                name=f"{name}, camera {kind.value}: share of those found in which a camera is named",
                value=named_share / max(1, sum(one.found for one in of_kind)),
            )
        )
    return Findings(checks, references)
