"""Comparisons of independent calibrations: differences beside both budgets, false alarms, and changes found.

Each case calibrates a simulated pair twice from different views. A comparison that calls them inconsistent is
a false alarm. Then the second camera of one rig is turned so far that points move by three, and by five times
what both budgets expect. The errors of the calibrations hide some of these changes: each has a theoretical
chance to be found, and the number of those found must be what these chances tell.
"""

from dataclasses import dataclass

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import PRINTS, BudgetSet, simulated_dots
from labcal.bench.solve.compare_power import power
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.cameras.camera import Camera
from labcal.cameras.rig import Rig
from labcal.evaluate.comparison.compare_settings import CompareSettings, Pictures
from labcal.evaluate.comparison.compared_rigs import compared
from labcal.evaluate.comparison.rig_comparison import LEAST_CHANCE
from labcal.geometry.poses import from_rotation_vector
from labcal.report.bench import Check, at_most
from labcal.report.values import Measured
from labcal.rng import generator
from labcal.run.cases import run_cases

PAIRS, QUICK_PAIRS = 20, 4
"""Of each kind of rig."""
VIEWS = 12
MOST_ALARMS, SQUARES_APART = 0.05, 0.1
CHANGES = (3.0, 5.0)
"""Sizes of changes in units of the expected RMS difference."""
_CHANCE = 2.6
"""Standard errors that chance is granted: 99% of a normal deviate."""
_SMALL_RAD = 1e-5
_HOW = CompareSettings(pictures=Pictures.DIFFERENT)


@dataclass(frozen=True)
class CompareCase:
    """A case: kind of pair, and seed."""

    kind: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.kind}-{self.seed}"


class CompareFigures(BaseModel):
    """Figures of one case."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    square: Measured
    """Squared RMS difference over the volume in units of the expected one."""
    p_value: Measured
    changed_p_value: tuple[Measured, ...]
    """After each change of a camera."""
    power: tuple[Measured, ...]
    """Theoretical chance that each change is found."""


def compare_findings(bench: Bench) -> Findings:
    """Return the shares of false alarms and of missed changes, and the size of differences."""
    seeds = range(bench.seed, bench.seed + (QUICK_PAIRS if bench.quick else PAIRS))
    cases = [CompareCase(kind, seed) for kind in KINDS for seed in seeds]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, compared_case, CompareFigures, bench.folder / "comparisons", executor, bench.progress
        )
    name, squares = f"compare, {len(cases)} pairs of calibrations", np.array([one.square for one in found])
    apart = SQUARES_APART + _CHANCE * float(squares.std()) / np.sqrt(len(squares))
    alarms = float(np.mean([one.p_value < LEAST_CHANCE for one in found]))
    off = abs(float(squares.mean()) - 1.0)
    checks = [
        at_most(f"{name}: squared differences in units of the expected ones, off 1", off, apart),
        at_most(f"{name}: share called inconsistent", alarms, MOST_ALARMS),
        *(_as_many_found(name, number, found) for number in range(len(CHANGES))),
    ]
    return Findings(checks, [])


def _as_many_found(name: str, number: int, cases: list[CompareFigures]) -> Check:
    """Return the check that as many changes of a size are found as their theoretical chances tell."""
    chance = np.array([one.power[number] for one in cases])
    found = sum(one.changed_p_value[number] < LEAST_CHANCE for one in cases)
    expected, spread = float(chance.sum()), float(np.sqrt((chance * (1.0 - chance)).sum()))
    return at_most(
        f"{name}: changes by {CHANGES[number]:g} expected differences, {found} found of {len(cases)}, "
        f"{expected:.1f} by theory, apart",
        abs(found - expected),
        0.5 + _CHANCE * spread,
    )


def compared_case(case: CompareCase) -> CompareFigures:
    """Calibrate twice, compare, change one camera, and compare again."""
    kind, rigs = KINDS[case.kind], list[Rig]()
    for half in ("first", "second"):
        random = generator(case.seed, "bench solve", "compare", case.kind, half)
        dots = simulated_dots(kind, BudgetSet(case.kind, PRINTS[0], VIEWS, "brown5", case.seed), random)
        settings = HandheldSettings(eccentricity_rounds=0)
        rigs.append(calibrate_handheld(dots, kind.target(), "brown5", settings).rig)
    one, other = rigs
    found = compared(one, other, _HOW).main
    by_small = compared(other, _turned(other, _SMALL_RAD), _HOW).main.rms
    unit = _SMALL_RAD * found.expected_of_both / by_small
    changed = [compared(one, _turned(other, unit * size), _HOW).main for size in CHANGES]
    random = generator(case.seed, "bench solve", "compare", case.kind, "power")
    return CompareFigures(
        square=(found.rms / found.expected_of_both) ** 2,
        p_value=found.p_value(),
        changed_p_value=tuple(after.p_value() for after in changed),
        power=tuple(power(found, after, LEAST_CHANCE, random) for after in changed),
    )


def _turned(rig: Rig, angle_rad: float) -> Rig:
    """Return a rig whose second camera is turned about its y axis, with the budget that it had."""
    cameras = {name: rig.camera(name) for name in CAMERAS}
    last = cameras[CAMERAS[1]]
    turn = from_rotation_vector(np.array([0.0, angle_rad, 0.0]), np.zeros(3))
    cameras[CAMERAS[1]] = Camera(last.K, last.lens, last.dist, turn @ last.T_cam_world, last.size)
    return rig.model_copy(update={"cameras": Rig.of(cameras).cameras})
