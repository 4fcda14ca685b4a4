"""The stated budget of points, distances, planes and motions against the truth of simulated sets.

Each set is calibrated anew. One set tells little: all of its points share the errors of one calibration, so
that its ellipsoids may hold all of them or half. Shares are therefore means over sets, and are compared with
95% up to what chance leaves of them.
"""

from itertools import product

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import CONFIDENCE, PRINTS, BudgetFigures, BudgetSet, measured_set
from labcal.bench.solve.named_points_growth import MILLION, QUICK_POINTS, named_points_checks
from labcal.bench.solve.print_treatments import treatment_findings
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases

SETS, QUICK_SETS = 30, 3
"""Of each cell."""
VIEWS = (6, 12, 25)
SIMPLE = "brown-k1k2"
"""One step too simple for all kinds."""
APART, LEAST, LEAST_SIMPLE = 0.02, 0.90, 0.88
SQUARES_APART = 0.05
_CHANCE = 2.6
"""Standard errors of a mean that chance is granted: of a hundred good ones, one is beyond."""
_WHAT = ("points", "distances", "planes", "motions")


def budget_findings(bench: Bench) -> Findings:
    """Return the coverage of 95% regions over all sets and by cell, and the scatter of the parameters."""
    seeds = range(bench.seed, bench.seed + (QUICK_SETS if bench.quick else SETS))
    cells = [(kind, surface, views, "brown5") for kind, surface, views in product(KINDS, PRINTS[:2], VIEWS)]
    cells += [(kind, PRINTS[2], 12, "brown5") for kind in KINDS]
    simple = [(kind, PRINTS[0], 12, SIMPLE) for kind in KINDS]
    cases = [BudgetSet(*cell, seed) for cell in (*cells, *simple) for seed in seeds]
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_set, BudgetFigures, bench.folder / "budgets", executor, bench.progress
        )
    by_cell: dict[tuple[str, str, int, str], list[BudgetFigures]] = {}
    for case, figures in zip(cases, found, strict=True):
        by_cell.setdefault((case.kind, case.surface, case.views, case.lens), []).append(figures)
    right = [one for cell in cells for one in by_cell[cell]]
    checks = [_off(f"budget, {len(right)} sets: coverage of {what}", right, what) for what in _WHAT]
    squares = np.array([one.parameters for one in right])
    name = f"budget, {len(right)} sets: squared errors of parameters in units of their covariance, off 1"
    checks.append(at_most(name, abs(float(squares.mean()) - 1.0), SQUARES_APART + _chance(squares)))
    references: list[Figure] = []
    for cell in cells:
        name = f"budget, {cell[0]}, {cell[1]} print, {cell[2]} views"
        shares = np.array([one.points for one in by_cell[cell]])
        short = LEAST - float(shares.mean())
        checks.append(at_most(f"{name}: points, coverage below {LEAST:g}", short, _chance(shares)))
        references.append(Figure(name=f"{name}: points, coverage", value=float(shares.mean())))
        alone = float(np.mean([one.noise_alone for one in by_cell[cell]]))
        references.append(Figure(name=f"{name}: points, coverage by noise alone", value=alone))
        of_cell = float(np.mean([one.parameters for one in by_cell[cell]]))
        references.append(Figure(name=f"{name}: squared errors of parameters, stated 1", value=of_cell))
    checks += [_of_simple(cell[0], by_cell[cell]) for cell in simple]
    points = QUICK_POINTS if bench.quick else MILLION
    checks += named_points_checks(bench.seed, points, bench.folder / "budgets")
    treatments = treatment_findings(bench)
    return Findings(checks + treatments.checks, references + treatments.references)


def _off(name: str, sets: list[BudgetFigures], what: str) -> Check:
    """Return the check that a mean share is 95% up to its limit and chance."""
    shares = np.array([getattr(one, what) for one in sets])
    return at_most(
        f"{name} off {CONFIDENCE}", abs(float(shares.mean()) - CONFIDENCE), APART + _chance(shares)
    )


def _chance(shares: np.ndarray) -> float:
    """Return the deviation that chance may cause in the mean of so many sets."""
    return float(_CHANCE * shares.std() / np.sqrt(len(shares)))


def _of_simple(kind: str, sets: list[BudgetFigures]) -> Check:
    """Return the check of a lens that is too simple: its sets are covered, or warned of."""
    trusted = [one for one in sets if not one.warned and one.points < LEAST_SIMPLE]
    name = f"budget, {kind}, '{SIMPLE}': share of sets with a coverage below {LEAST_SIMPLE} and no warning"
    return at_most(name, len(trusted) / len(sets), 0.0)
