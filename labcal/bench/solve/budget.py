"""The stated budget of points, distances, planes and motions against the truth of simulated sets.

Each set is calibrated anew. One set tells little: all of its points share the errors of one calibration, so
that its ellipsoids may hold all of them or half. Shares are therefore means over sets. A cell of the design
that is below its limit after its first sets is measured on more of them, so that chance decides nothing.
"""

from itertools import product
from typing import NamedTuple

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
MOST_SETS = 120
"""Of a cell with a coverage below its limit after the first sets. The standard error is then 0.01 to 0.02, so
that a true coverage of 0.95 hardly ever stays below 0.90."""
VIEWS = (6, 12, 25)
SIMPLE = "brown-k1k2"
"""One step too simple for all kinds."""
APART, LEAST, LEAST_SIMPLE = 0.02, 0.90, 0.88
SQUARES_APART = 0.05
_CHANCE = 2.6
"""Standard errors of a mean that chance is granted: of a hundred good ones, one is beyond."""
_WHAT = ("points", "distances", "planes", "motions")


class Cell(NamedTuple):
    """A cell of the design: kind of pair, print, number of views, lens model of the calibration."""

    kind: str
    surface: str
    views: int
    lens: str

    def __str__(self) -> str:
        return f"{self.kind}, {self.surface} print, {self.views} views"


def budget_findings(bench: Bench) -> Findings:
    """Return the coverage of 95% regions over all sets and by cell, and the scatter of the parameters."""
    cells = [
        Cell(kind, surface, views, "brown5") for kind, surface, views in product(KINDS, PRINTS[:2], VIEWS)
    ]
    cells += [Cell(kind, PRINTS[2], 12, "brown5") for kind in KINDS]
    simple = [Cell(kind, PRINTS[0], 12, SIMPLE) for kind in KINDS]
    first = bench.seed + (QUICK_SETS if bench.quick else SETS)
    by_cell = _measured([*cells, *simple], range(bench.seed, first), bench)
    # Of every cell as many sets: those that were chosen for their coverage have no part in the mean of all.
    right = [one for cell in cells for one in by_cell[cell]]
    granted = _CHANCE if bench.quick else 0.0
    checks = [_off(f"budget, {len(right)} sets: coverage of {what}", right, what, granted) for what in _WHAT]
    squares = np.array([one.parameters for one in right])
    name = f"budget, {len(right)} sets: squared errors of parameters in units of their covariance, off 1"
    checks.append(
        at_most(name, abs(float(squares.mean()) - 1.0), SQUARES_APART + _CHANCE * standard_error(squares))
    )
    if not bench.quick:
        low = [cell for cell in cells if min(_means(by_cell[cell])) < LEAST]
        for cell, more in _measured(low, range(first, bench.seed + MOST_SETS), bench).items():
            by_cell[cell] += more
    references: list[Figure] = []
    for cell in cells:
        checks.append(cell_check(cell, by_cell[cell], granted))
        references += _figures_of_cell(cell, by_cell[cell])
    checks += [_of_simple(cell.kind, by_cell[cell]) for cell in simple]
    points = QUICK_POINTS if bench.quick else MILLION
    checks += named_points_checks(bench.seed, points)
    treatments = treatment_findings(bench)
    return Findings(checks + treatments.checks, references + treatments.references)


def _measured(cells: list[Cell], seeds: range, bench: Bench) -> dict[Cell, list[BudgetFigures]]:
    """Return the figures of the sets of cells."""
    cases = [BudgetSet(*cell, seed) for cell in cells for seed in seeds]
    if not cases:
        return {}
    with bench.executor(len(cases)) as executor:
        found = run_cases(
            cases, measured_set, BudgetFigures, bench.folder / "budgets", executor, bench.progress
        )
    each = len(seeds)
    return {cell: found[number * each : (number + 1) * each] for number, cell in enumerate(cells)}


def _off(name: str, sets: list[BudgetFigures], what: str, granted: float) -> Check:
    """Return the check that a mean share is 95% up to its limit; `granted` standard errors are chance."""
    shares = np.array([getattr(one, what) for one in sets])
    off = abs(float(shares.mean()) - CONFIDENCE)
    return at_most(f"{name} off {CONFIDENCE}", off, APART + granted * standard_error(shares))


def cell_check(cell: Cell, sets: list[BudgetFigures], granted: float) -> Check:
    """Return the check of the least coverage of a cell: of points, distances, planes or motions.

    Parameters
    ----------
    cell : Cell
    sets : list of BudgetFigures
    granted : float
        Standard errors of that coverage which are chance.
    """
    means = _means(sets)
    least = int(np.argmin(means))
    chance = granted * standard_error(np.array([getattr(one, _WHAT[least]) for one in sets]))
    name = f"budget, {cell}, {len(sets)} sets: least coverage ({_WHAT[least]}) below {LEAST:g}"
    return at_most(name, LEAST - means[least], chance)


def _figures_of_cell(cell: Cell, sets: list[BudgetFigures]) -> list[Figure]:
    """Return the coverages of a cell with their standard errors, and what else its sets show."""
    figures: list[Figure] = []
    for what, mean in zip(_WHAT, _means(sets), strict=True):
        error = standard_error(np.array([getattr(one, what) for one in sets]))
        figures.append(Figure(name=f"budget, {cell}: {what}, coverage", value=mean))
        figures.append(Figure(name=f"budget, {cell}: {what}, standard error of the coverage", value=error))
    alone = float(np.mean([one.noise_alone for one in sets]))
    figures.append(Figure(name=f"budget, {cell}: points, coverage by noise alone", value=alone))
    squares = float(np.mean([one.parameters for one in sets]))
    figures.append(Figure(name=f"budget, {cell}: squared errors of parameters, stated 1", value=squares))
    return figures


def _means(sets: list[BudgetFigures]) -> list[float]:
    """Return the mean shares of points, distances, planes and motions."""
    return [float(np.mean([getattr(one, what) for one in sets])) for what in _WHAT]


def standard_error(shares: np.ndarray) -> float:
    """Return the standard error of a mean over sets, whose own shares are independent."""
    return float(shares.std(ddof=1) / np.sqrt(len(shares)))


def _of_simple(kind: str, sets: list[BudgetFigures]) -> Check:
    """Return the check of a lens that is too simple: its sets are covered, or warned of."""
    trusted = [one for one in sets if not one.warned and one.points < LEAST_SIMPLE]
    name = f"budget, {kind}, '{SIMPLE}': share of sets with a coverage below {LEAST_SIMPLE} and no warning"
    return at_most(name, len(trusted) / len(sets), 0.0)
