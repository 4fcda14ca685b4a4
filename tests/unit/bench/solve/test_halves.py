"""Halves of the views differ by what their budgets explain, where these hold."""

from dataclasses import replace

import numpy as np

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import BudgetSet, simulated_dots
from labcal.bench.solve.half_points import point_differences
from labcal.bench.solve.halves import halves, squared_differences
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.distributions import chi2_quantile
from labcal.rng import generator


def test_differences_of_halves_follow_chi_square() -> None:
    kind = KINDS["webcam"]
    dots = simulated_dots(kind, BudgetSet("webcam", "even", 12, "brown5", 1), generator(1, "halves"))
    one, other = (
        calibrate_handheld(half, kind.target(), "brown5", HandheldSettings(eccentricity_rounds=0))
        for half in halves(dots)
    )
    squares, freedom = squared_differences(one, other)
    assert freedom == 24
    assert chi2_quantile(0.005, freedom) < squares < chi2_quantile(0.995, freedom)
    for found in point_differences(one, other):
        assert 2 <= found.freedom < 24  # directions that matter, not points
        assert found.squares < chi2_quantile(0.995, found.freedom)
    assert one.rig.covariance is not None
    # A focal length that is off by ten of its standard deviations shows.
    left = one.rig.cameras["left"]
    off = 10.0 * float(np.sqrt(one.rig.covariance.matrix[0, 0]))
    K = ((left.K[0][0] + off, *left.K[0][1:]), *left.K[1:])
    cameras = {**one.rig.cameras, "left": left.model_copy(update={"K": K})}
    moved = replace(one, rig=one.rig.model_copy(update={"cameras": cameras}))
    assert squared_differences(moved, other)[0] > chi2_quantile(0.999999, freedom)
    # Depth is off by the focal length, and lengths with it.
    for found in point_differences(moved, other):
        assert found.squares > chi2_quantile(0.999999, found.freedom)
