"""``labcal bench solve --only diagnose``: mistakes that are named, and good shoots that are accused."""

from collections.abc import Sequence

import numpy as np

from labcal.bench.diagnose.case import DiagnosedFigures, DiagnosedShoot, diagnosed_shoot
from labcal.bench.diagnose.sizes import LEVELS
from labcal.bench.groups import Bench, Findings
from labcal.guide.diagnosis.check_name import CheckName
from labcal.report.bench import Figure, at_most
from labcal.run.cases import run_cases

MISSED, ACCUSED = 0.05, 0.02
_SEEDS, _QUICK_SEEDS = 7, 1
"""Shoots of each mistake at each size: 315 in all."""
_GOOD, _QUICK_GOOD = 300, 12
_DRAWN_SHARE = 5
"""One of so many good shoots has pictures; with no divisor in common with the number of rigs."""
_TOGETHER = (
    (("camera-moved", 2), ("bent-board", 0)),
    (("refocused", 2), ("wrong-pitch", 0)),
    (("unsynchronised", 2), ("bent-board", 0)),
    (("poor-coverage", 2), ("bent-board", 0)),
    (("swapped-cameras", 1), ("camera-moved", 0)),
    (("turned-target", 1), ("wrong-pitch", 0)),
)
"""Several mistakes at once, the more harmful first."""


def diagnose_findings(bench: Bench) -> Findings:
    """Return the shares of mistakes that are named rightly, and of good shoots that are accused."""
    seeds = range(bench.seed, bench.seed + (_QUICK_SEEDS if bench.quick else _SEEDS))
    single = [
        DiagnosedShoot(((check.value, level),), seed)
        for check in CheckName
        for level in range(LEVELS)
        for seed in seeds
    ]
    several = [DiagnosedShoot(mistakes, seed) for mistakes in _TOGETHER for seed in seeds]
    count = _QUICK_GOOD if bench.quick else _GOOD
    good = [
        DiagnosedShoot((), seed, drawn=seed % _DRAWN_SHARE == 0)
        for seed in range(bench.seed, bench.seed + count)
    ]
    cases = [*single, *several, *good]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, diagnosed_shoot, DiagnosedFigures, bench.folder / "shoots", executor, bench.progress
        )
    table = dict(zip(cases, found, strict=True))
    right = [is_right(case, table[case]) for case in single]
    accused = [bool(table[case].named) for case in good]
    ordered = [_in_order(case, table[case]) for case in several]
    what = f"diagnose, {len(single)} mistakes"
    checks = [
        at_most(f"{what}: share not named rightly", float(np.mean(np.logical_not(right))), MISSED),
        at_most(f"diagnose, {count} good shoots: share accused", float(np.mean(accused)), ACCUSED),
    ]
    references = [
        *_by_check(single, right),
        Figure(
            name=f"diagnose, {len(several)} shoots with two mistakes: share with both, in the order of harm",
            value=float(np.mean(ordered)),
        ),
    ]
    return Findings(checks, references)


def is_right(case: DiagnosedShoot, found: DiagnosedFigures) -> bool:
    """Tell whether the only mistake is the one that is named first."""
    return found.named[:1] == (case.mistakes[0][0],)


def _in_order(case: DiagnosedShoot, found: DiagnosedFigures) -> bool:
    wanted = tuple(name for name, _ in case.mistakes)
    return tuple(name for name in found.named if name in wanted) == wanted


def _by_check(cases: Sequence[DiagnosedShoot], right: Sequence[bool]) -> list[Figure]:
    figures = []
    for check in CheckName:
        for level in range(LEVELS):
            of = [
                good
                for case, good in zip(cases, right, strict=True)
                if case.mistakes[0] == (check.value, level)
            ]
            name = f"diagnose, {check.value}, size {level + 1} of {LEVELS}: share named rightly"
            figures.append(Figure(name=name, value=float(np.mean(of))))
    return figures
