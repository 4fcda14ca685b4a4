"""Motions of dots without the gauge, and what may be kept."""

import numpy as np
import pytest

from labcal.calibrate.adjustment.dot_freedom import (
    SHAPES,
    Constrained,
    DatumConstraint,
    dot_freedom,
    plane_modes,
)
from labcal.errors import InputError
from labcal.targets.grid import DotGrid


@pytest.mark.parametrize(
    ("parts", "free"), [(Constrained.NOTHING, 3 * 18 - 7), (Constrained.HEIGHTS, 2 * 18 - 4)]
)
def test_the_gauge_is_taken_out(grid: DotGrid, parts: Constrained, free: int) -> None:
    movable = np.arange(grid.count) >= 2
    p = grid.points()
    basis = dot_freedom(p, movable, DatumConstraint(parts, np.zeros((p.size, 0))))
    assert basis.shape == (p.size, free)
    np.testing.assert_allclose(basis.T @ basis, np.eye(free), atol=1e-12)
    d = (basis @ np.random.default_rng(1).normal(size=free)).reshape(-1, 3)
    assert (d[:2] == 0.0).all()
    assert (d[:, 2] == 0.0).all() == (parts is Constrained.HEIGHTS)
    away = p[movable] - p[movable].mean(axis=0)
    np.testing.assert_allclose(d.sum(axis=0), 0.0, atol=1e-10)
    np.testing.assert_allclose(np.cross(away, d[movable]).sum(axis=0)[2], 0.0, atol=1e-9)
    assert (away * d[movable]).sum() == pytest.approx(0.0, abs=1e-9)


def test_kept_directions_stay(grid: DotGrid) -> None:
    movable = np.ones(grid.count, dtype=bool)
    modes = plane_modes(grid.points(), movable)
    np.testing.assert_allclose(modes.T @ modes, np.eye(8), atol=1e-12)
    kept = modes[:, -SHAPES:][:, :1]
    basis = dot_freedom(grid.points(), movable, DatumConstraint(Constrained.STRETCH, kept))
    assert basis.shape[1] == 3 * grid.count - 8
    np.testing.assert_allclose(kept.T @ basis, 0.0, atol=1e-12)
    x, y = (grid.points()[:, :2] - grid.points()[:, :2].mean(axis=0)).T
    stretch = np.stack([x, -y, 0 * x], axis=-1).ravel()
    inside = modes[:, 4:6] @ (modes[:, 4:6].T @ stretch)
    # What of the stretch is no change of scale lies in the modes of stretch.
    scale = modes[:, 3] * (modes[:, 3] @ stretch)
    np.testing.assert_allclose(inside + scale, stretch, atol=1e-9)


def test_too_many_dots_are_refused(grid: DotGrid) -> None:
    many = grid.model_copy(update={"cols": 60, "rows": 40})
    with pytest.raises(InputError, match="2400 dots would be free"):
        dot_freedom(many.points(), np.ones(2400, dtype=bool), DatumConstraint.nothing(2400))
