"""Figures of a method: of one whose errors are known, and of one that refuses the data."""

import numpy as np
import pytest
from jaxtyping import Float64

from labcal.bench.distortion.case import Case, Cell, Layout, Measured
from labcal.bench.distortion.cell_data import CellData, RegionPoints, cell_data
from labcal.bench.distortion.measuring import measured_case, region_figures
from labcal.errors import InputError
from labcal.estimators.dlt import Dlt
from labcal.rng import generator

COVARIANCE = np.array([[1.0, 0.3, 0.0], [0.3, 2.0, -0.4], [0.0, -0.4, 4.0]])


class TruthAndNoise(Dlt):
    """A method that returns the true points and errors of a known covariance, which it states."""

    def __init__(self, data: CellData, stated: float) -> None:
        self.data, self.stated = data, stated

    def predict_with_covariance(
        self,
        X: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],  # noqa: ARG002 - as of every method
    ) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "n 3 3"]]:
        """Return them; it knows the points from its data."""
        p = self.data.tests[Measured.WITHIN].p
        error = generator(1, "test").multivariate_normal(np.zeros(3), COVARIANCE, len(X))
        return p + error, np.tile(self.stated * COVARIANCE, (len(X), 1, 1))


@pytest.fixture(scope="module")
def data() -> CellData:
    cell = Cell("brown", 0.5, 0.1, 60, Layout.PLANES)
    return cell_data(Case(cell, 0, ("dlt",), (Measured.WITHIN,), 2000))


def test_known_errors_give_the_known_figures(data: CellData) -> None:
    found = region_figures(TruthAndNoise(data, 1.0), data, Measured.WITHIN)
    n, trace = found.n, np.trace(COVARIANCE)
    spread = np.sqrt(2.0 * (COVARIANCE**2).sum() / n)  # of the mean of squares of normal errors
    assert abs(found.rmse_mm**2 - trace) < 4.0 * spread
    assert abs(found.coverage95 - 0.95) < 4.0 * np.sqrt(0.95 * 0.05 / n)
    assert (found.n, found.predicted, found.stated) == (2000, 2000, 2000)
    tests: RegionPoints = data.tests[Measured.WITHIN]
    oracle = np.sqrt(((tests.oracle - tests.p) ** 2).sum(axis=1).mean())
    assert found.over_oracle == pytest.approx(found.rmse_mm / oracle)


def test_too_small_a_covariance_covers_too_little(data: CellData) -> None:
    """Of normal errors in three dimensions, 42.5 % lie within half the radius of the 95 % ellipsoid."""
    found = region_figures(TruthAndNoise(data, 0.25), data, Measured.WITHIN)
    assert abs(found.coverage95 - 0.4247) < 4.0 * np.sqrt(0.4247 * 0.5753 / found.n)


class FarAway(TruthAndNoise):
    """A method that gives all places but the first one beyond all sense."""

    def predict_with_covariance(
        self,
        X: Float64[np.ndarray, "n inputs"],
        pixel_covariance: Float64[np.ndarray, "n cameras 2 2"],
    ) -> tuple[Float64[np.ndarray, "n 3"], Float64[np.ndarray, "n 3 3"]]:
        """Return them; squares of the second place are infinite."""
        found, stated = super().predict_with_covariance(X, pixel_covariance)
        found[1:], found[1] = 1e10, 1e200
        return found, stated


def test_places_beyond_all_sense_are_no_places(data: CellData) -> None:
    found = region_figures(FarAway(data, 1.0), data, Measured.WITHIN)
    assert (found.n, found.predicted, found.stated, found.extrapolated) == (2000, 1, 1, 0)
    assert 0.0 < found.rmse_mm < 20.0


@pytest.mark.slow
def test_a_refusal_is_a_line_with_its_reason_and_stops_no_other_method() -> None:
    cell = Cell("brown", 0.5, 0.1, 60, Layout.PLANES)
    case = Case(cell, 0, ("two-plane", "dlt"), (Measured.WITHIN,), 50, {"two-plane": {"degree": 9}})
    refused, measured = measured_case(case).methods
    assert refused.regions == ()
    assert refused.reason is not None
    assert refused.reason.startswith("InputError: two-plane: ")
    assert measured.reason is None
    assert measured.misfit is True  # a linear method on a lens with k1 = -0.25
    assert measured.regions[0].over_oracle > 2.0


def test_a_method_that_does_not_exist_is_an_error() -> None:
    case = Case(Cell("brown", 0.0, 0.1, 60, Layout.PLANES), 0, ("dtl",), (Measured.WITHIN,), 50)
    with pytest.raises(InputError, match="Did you mean 'dlt'"):
        measured_case(case)
