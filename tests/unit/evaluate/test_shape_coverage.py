"""Planes and motions in units of their joint covariance, against cameras that are drawn anew."""

import numpy as np
import pytest

from labcal import Points, Rig, examples
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.rig_covariance import RigCovariance
from labcal.evaluate.aligned_budget import PointOrigin
from labcal.evaluate.shape_coverage import ShapeCoverage, shape_coverage
from labcal.reconstruct.point_budget import Budget
from labcal.reconstruct.reconstruction import reconstruct_centres

SIGMA = np.array([*([0.5] * 4 + [1e-3, 1e-3, 1e-4, 1e-4, 1e-3]) * 2, 1e-3, 1e-3, 1e-3, 0.1, 0.1, 0.1])
DRAWS = 24


def drawn(rng: np.random.Generator, factor: float = 1.0) -> Rig:
    """Return the example's rig with errors of the covariance that it states, times a factor."""
    plain = examples.rig()
    state = RigState(tuple(plain.camera(name) for name in plain.cameras), np.eye(4)[None], np.zeros((1, 3)))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
    off = layout.stepped(factor * SIGMA * rng.standard_normal(24), np.zeros((1, 6))).cameras
    wrong = Rig.of(dict(zip(plain.cameras, off, strict=True)))
    return wrong.model_copy(update={"covariance": RigCovariance.of(wrong.cameras, np.diag(SIGMA**2))})


def covered(rig: Rig) -> ShapeCoverage:
    """Return the coverage against the exact rig, with the same noise of pixels: the cameras' errors rule."""
    dots = examples.detections()
    true = reconstruct_centres(examples.rig(), dots, None).points.point
    return shape_coverage(reconstruct_centres(rig, dots, None).points, true, PointOrigin(rig), dots)


def test_95_percent_of_planes_and_motions_are_within_95_percent() -> None:
    rng = np.random.default_rng(8)
    found = [covered(drawn(rng)) for _ in range(DRAWS)]
    assert {(one.n_planes, one.n_motions) for one in found} == {(8, 7)}
    # Those of a rig share its errors: a rig counts as few values, and shares of rigs scatter by some 0.1.
    assert np.mean([one.planes for one in found]) == pytest.approx(0.95, abs=0.08)
    assert np.mean([one.motions for one in found]) == pytest.approx(0.95, abs=0.08)


def test_errors_that_are_larger_than_stated_are_not_covered() -> None:
    rng = np.random.default_rng(9)
    found = [covered(drawn(rng, 4.0)) for _ in range(4)]
    assert np.mean([one.planes for one in found]) < 0.7
    assert np.mean([one.motions for one in found]) < 0.7


def test_points_of_noise_alone_or_of_no_plane_have_none() -> None:
    rig, dots = drawn(np.random.default_rng(1)), examples.detections()
    noise = reconstruct_centres(rig, dots, None, Budget.NOISE).points
    assert shape_coverage(noise, noise.point, PointOrigin(rig), dots).n_planes == 0
    full = reconstruct_centres(rig, dots, None).points
    bent = full.point + 0.02 * (full.point[:, :1] ** 2) * [0.0, 0.0, 1.0]
    moved = Points(full.view, full.index, bent, full.covariance, full.flag)
    assert np.isnan(shape_coverage(full, moved.point, PointOrigin(rig), dots).planes)
