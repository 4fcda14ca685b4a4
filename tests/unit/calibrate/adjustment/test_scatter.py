"""Scatter beyond the stated covariances, found from residuals that have a known one."""

import numpy as np
import pytest

from labcal.calibrate.adjustment.scatter import Scatter


def residuals(extra: float, n: int = 20_000) -> tuple[np.ndarray, np.ndarray]:
    random = np.random.default_rng(3)
    root = random.uniform(0.02, 0.2, (n, 1, 1)) * (np.eye(2) + 0.2 * random.normal(size=(n, 2, 2)))
    covariance = root @ root.transpose(0, 2, 1)
    own = np.einsum("nij,nj->ni", root, random.normal(size=(n, 2)))
    return own + extra * random.normal(size=(n, 2)), covariance


@pytest.mark.parametrize("extra", [0.02, 0.3])
def test_it_is_found(extra: float) -> None:
    residual, covariance = residuals(extra)
    # The relative deviation of a variance from 40,000 components is sqrt(2 / 40000) where the extra rules.
    assert np.sqrt(Scatter.of(residual, covariance, 1.0).extra_variance()) == pytest.approx(extra, rel=0.04)


def test_none_is_invented() -> None:
    residual, covariance = residuals(0.0)
    assert Scatter.of(residual, 1.1 * covariance, 1.0).extra_variance() == 0.0
    assert Scatter.of(residual, 0.5 * covariance, 1.0).extra_variance() > 0.0


def test_unknowns_take_up_some() -> None:
    residual, covariance = residuals(0.1)
    assert (
        Scatter.of(residual, covariance, 0.5).extra_variance()
        > 1.5 * Scatter.of(residual, covariance, 1.0).extra_variance()
    )
