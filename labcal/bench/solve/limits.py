"""Errors of methods relative to the physical limit, their stated covariances, and their expected errors."""

from collections.abc import Collection

import numpy as np

from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.comparison import (
    METHODS,
    RIGHT,
    Comparison,
    ComparisonFigures,
    MethodFigures,
    compared,
)
from labcal.bench.solve.families import FAMILIES
from labcal.report.bench import Check, Figure, at_most
from labcal.run.cases import run_cases
from labcal.run.code_version import module_digest

SEEDS, QUICK_SEEDS = 5, 1
SLOW = ("mlp", "mlp-bayes", "ray-net")
"""Left out in a quick run: they train for minutes."""
RIGHT_LIMIT, HYBRID_LIMIT = 1.03, 1.10
COVERAGE, APART = 0.95, 0.02
TRUSTED_COVERAGE = 0.90
CHOSEN_LIMIT = 1.05
"""Of the method that training data choose, over the one that was best."""


def limit_findings(bench: Bench) -> Findings:
    """Return medians over seeds by family and method.

    User methods are shown for reference; only methods of labcal are checked.
    """
    own = tuple(method for method in METHODS if not (bench.quick and method in SLOW))
    methods = tuple(dict.fromkeys((*own, *bench.methods)))
    seeds = range(bench.seed, bench.seed + (QUICK_SEEDS if bench.quick else SEEDS))
    own_code = tuple(module_digest(method.partition(":")[0]) for method in methods if ":" in method)
    comparisons = [Comparison(family.name, seed, methods, own_code) for seed in seeds for family in FAMILIES]
    with bench.executor(len(comparisons)) as executor:
        found = run_cases(
            comparisons, compared, ComparisonFigures, bench.folder / "duels", executor, bench.progress
        )
    checks: list[Check] = []
    references: list[Figure] = []
    for family in FAMILIES:
        of_family = [one for one in found if one.family == family.name]
        for method in methods:
            figures = [one for comparison in of_family for one in comparison.methods if one.method == method]
            if not figures:
                continue
            name = f"limits, {family.name}: {method}"
            ratio = float(np.median([one.ratio for one in figures]))
            covered = float(np.median([one.coverage95 for one in figures]))
            if method in {RIGHT, "hybrid"}:
                exact = method == RIGHT or family.parametric
                limit = RIGHT_LIMIT if exact else HYBRID_LIMIT
                checks.append(at_most(f"{name}, RMS error over the oracle's", ratio, limit))
                apart = abs(covered - COVERAGE)
                checks.append(at_most(f"{name}, coverage of 95% ellipsoids off {COVERAGE}", apart, APART))
            else:
                references.append(Figure(name=f"{name}, RMS error over the oracle's", value=ratio))
                references.append(Figure(name=f"{name}, coverage of 95% ellipsoids", value=covered))
        chosen = float(np.median([_chosen_over_best(comparison, own) for comparison in of_family]))
        name = f"limits, {family.name}: method that training data choose, over the best"
        checks.append(at_most(name, chosen, CHOSEN_LIMIT))
    trusted = sum(
        _wrongly_trusted(one) for comparison in found for one in comparison.methods if one.method in own
    )
    name = f"limits: methods with a coverage below {TRUSTED_COVERAGE:g} and no flag 'model-misfit'"
    checks.append(at_most(name, float(trusted), 0.0))
    return Findings(checks, references)


def _wrongly_trusted(figures: MethodFigures) -> bool:
    return figures.refusal is None and not figures.coverage95 >= TRUSTED_COVERAGE and not figures.misfit


def _chosen_over_best(comparison: ComparisonFigures, methods: Collection[str]) -> float:
    """Return the error of the method with the smallest expected error over the smallest error of all.

    Of the methods that are given, but for the right family: who knows it needs no choice.
    """
    known = [
        one
        for one in comparison.methods
        if one.refusal is None and one.method != RIGHT and one.method in methods
    ]
    chosen = min(known, key=lambda one: one.rehearsed_mm)
    return chosen.ratio / min(one.ratio for one in known)
