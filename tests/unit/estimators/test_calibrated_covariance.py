"""Covariances calibrated on a surrogate, judged on points that the true cameras see."""

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout, Measured
from labcal.bench.distortion.cell_data import CellData, cell_data
from labcal.bench.families.cameras import SIZE
from labcal.estimators.bundle import Bundle
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.networks.mlp import Mlp
from labcal.estimators.surrogate_validation import fit_unless_surrogate, surrogate_of
from labcal.estimators.two_plane import TwoPlane
from labcal.evaluate.statistics import coverage

SIZES = (SIZE, SIZE)
NOISE_PX, TESTS = 0.1, 1000


def data_of(seed: int) -> CellData:
    """Return training data of 60 dots of pinhole cameras, and points to test on."""
    cell = Cell("brown", 0.0, NOISE_PX, 60, Layout.PLANES)
    return cell_data(Case(cell, seed, (), (Measured.WITHIN,), TESTS))


def covered(estimator: PointEstimator, data: CellData) -> float:
    """Return the share of true errors within the 95% ellipsoids."""
    test = data.tests[Measured.WITHIN]
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(test.p), 2, 1, 1))
    points, stated = estimator.predict_with_covariance(test.q.reshape(len(test.p), -1), covariance)
    return coverage(points - test.p, stated)


def test_a_network_that_knows_its_dots_by_heart_states_what_it_errs_by() -> None:
    data = data_of(0)
    plain, surrogate = (
        Mlp(max_epochs=60).fit(data.X, data.Y),
        surrogate_of(data.X, data.Y, SIZES, 0, "pinhole"),
    )
    assert surrogate is not None
    assert covered(plain, data) < 0.7
    fitted = fit_unless_surrogate(surrogate, Mlp(max_epochs=60), data.X, data.Y)
    assert fitted.own_scale_ > 1.0
    assert abs(covered(fitted, data) - 0.95) < 0.03
    bundle = fit_unless_surrogate(surrogate, Bundle("pinhole", SIZES), data.X, data.Y)
    assert bundle.own_scale_ == 1.0


@pytest.mark.slow
def test_single_fits_cover_their_share_although_their_points_share_an_error() -> None:
    """By itself a method covers 95% on average over fits of few dots, and in one fit far less or more."""
    by_itself, calibrated = [], []
    for seed in range(6):
        data = data_of(seed)
        surrogate = surrogate_of(data.X, data.Y, SIZES, seed, "pinhole")
        assert surrogate is not None
        by_itself.append(covered(TwoPlane(3).fit(data.X, data.Y), data))
        calibrated.append(covered(fit_unless_surrogate(surrogate, TwoPlane(3), data.X, data.Y), data))
    assert np.std(by_itself) > 0.02  # else this would test nothing
    assert np.std(calibrated) < 0.6 * np.std(by_itself)
    assert abs(np.mean(calibrated) - 0.95) < 0.015
