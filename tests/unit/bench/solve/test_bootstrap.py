"""Samples of views scatter as stated sigmas imply, where these are right."""

import numpy as np
import pytest

from labcal.bench.solve.bootstrap import BootstrapScatter
from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import BudgetSet, simulated_dots
from labcal.errors import InputError
from labcal.rng import generator


@pytest.mark.slow
def test_samples_scatter_as_stated() -> None:
    """Of ten views the scatter is known to some quarter; a sigma that is off by three shows."""
    kind, ratios = KINDS["webcam"], []
    for seed in range(3):
        case = BudgetSet("webcam", "even", 10, "brown5", seed)
        dots = simulated_dots(kind, case, generator(seed, "samples"))
        found = BootstrapScatter.of(dots, kind.target(), case.lens, seed, 0)
        ratios.append((found.focal, found.middle, found.baseline))
    assert (np.sqrt(np.square(ratios).mean(axis=0)) < 1.6).all()
    assert (np.sqrt(np.square(ratios).mean(axis=0)) > 0.5).all()


def test_few_views_are_refused() -> None:
    kind = KINDS["webcam"]
    dots = simulated_dots(kind, BudgetSet("webcam", "even", 5, "brown5", 0), generator(0, "samples"))
    with pytest.raises(InputError, match="Of 5 views half are too few"):
        BootstrapScatter.of(dots, kind.target(), "brown5", 0, 0)
