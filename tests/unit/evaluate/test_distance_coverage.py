"""Distances in units of their joint sigma, against cameras that are drawn anew."""

import numpy as np
import pytest

from labcal import Rig, examples
from labcal.calibrate.adjustment.state import Freedom, Layout, Lenses, RigState
from labcal.cameras.rig_covariance import RigCovariance
from labcal.evaluate.aligned_budget import PointOrigin
from labcal.evaluate.distance_coverage import distance_coverage
from labcal.reconstruct.point_budget import Budget
from labcal.reconstruct.reconstruction import reconstruct_centres

SIGMA = np.array([*([0.5] * 4 + [1e-3, 1e-3, 1e-4, 1e-4, 1e-3]) * 2, 1e-3, 1e-3, 1e-3, 0.1, 0.1, 0.1])
DRAWS = 16


def drawn(rng: np.random.Generator) -> Rig:
    """Return the example's rig with errors of the covariance that it states."""
    plain = examples.rig()
    cameras = tuple(plain.camera(name) for name in plain.cameras)
    state = RigState(cameras, np.eye(4)[None], np.zeros((1, 3)))
    layout = Layout(state, Freedom(Lenses.FREE, np.zeros((3, 0))))
    off = layout.stepped(SIGMA * rng.standard_normal(24), np.zeros((1, 6))).cameras
    wrong = Rig.of(dict(zip(plain.cameras, off, strict=True)))
    return wrong.model_copy(update={"covariance": RigCovariance.of(wrong.cameras, np.diag(SIGMA**2))})


def test_95_percent_of_distances_are_within_95_percent() -> None:
    dots, rng = examples.detections(), np.random.default_rng(6)
    true = reconstruct_centres(
        examples.rig(), dots, None
    ).points.point  # the same noise: the cameras' errors rule
    shares = [
        distance_coverage(reconstruct_centres(rig, dots, None).points, true, PointOrigin(rig), dots)
        for rig in (drawn(rng) for _ in range(DRAWS))
    ]
    # Distances of a rig share its errors, so that shares scatter by some 0.1.
    assert np.mean(shares) == pytest.approx(0.95, abs=0.08)


def test_points_of_noise_alone_have_none() -> None:
    rig, dots = drawn(np.random.default_rng(1)), examples.detections()
    points = reconstruct_centres(rig, dots, None, Budget.NOISE).points
    assert np.isnan(distance_coverage(points, points.point, PointOrigin(rig), dots))
