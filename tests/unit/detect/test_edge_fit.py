"""The edge fit against discs with an analytic profile: bias, the stated covariance, and what it refuses."""

import numpy as np
import pytest
from scipy.special import ndtr

from labcal.detect.edge_fit import fit_edge
from labcal.detect.noise import noise_factor

STEP = 170.0


def disc(centre: np.ndarray, radius: float, hole: float = 0.0) -> np.ndarray:
    """A blurred disc, averaged over pixels, on a sloping ground."""
    side, fine = int(2 * radius + 26), 5
    k = (np.arange(side * fine) + 0.5) / fine - 0.5
    x, y = np.meshgrid(k, k)
    distance = np.hypot(x - centre[0], y - centre[1])
    inside = ndtr((radius - distance) / 0.6) - (ndtr((hole * radius - distance) / 0.6) if hole else 0)
    value = (200 - STEP * inside) * (1 + 0.1 * (x - side / 2) / side)
    return value.reshape(side, fine, side, fine).mean((1, 3))


@pytest.mark.parametrize(("radius", "noise"), [(3.5, 2.0), (6.0, 2.0), (6.0, 8.0), (20.0, 2.0)])
def test_bias_and_covariance(radius: float, noise: float) -> None:
    rng = np.random.default_rng(7)
    normed, n, fits = [], 90, []
    for k in range(n):
        centre = radius + 13 + rng.uniform(-0.5, 0.5, 2)
        clean = disc(centre, radius)
        start = centre + rng.uniform(-0.3, 0.3, 2)
        picture = (clean + rng.normal(0, noise, clean.shape)).astype(np.float32)
        fit = fit_edge(picture, start, np.eye(2) * (radius * 1.05) ** 2, 0.0, 2.5)
        assert fit is not None
        fits.append(fit)
        normed.append(np.linalg.solve(np.linalg.cholesky(fit.covariance), fit.centre - centre))
        if k < 10:
            exact = fit_edge(clean.astype(np.float32), start, np.eye(2) * (radius * 0.95) ** 2, 0.0, 2.5)
            assert exact is not None
            assert np.abs(exact.centre - centre).max() < 0.004
    chi2 = float((np.array(normed) ** 2).sum())
    dof = 2 * n
    assert abs(chi2 - dof) < 4 * np.sqrt(2 * dof)
    assert np.abs(np.mean(normed, axis=0)).max() < 4 / np.sqrt(n)
    assert noise_factor([fit.scatter for fit in fits]) < 1.15


def test_standard_deviation_is_near_the_cramer_rao_bound() -> None:
    # DESIGN: 0.0057 px at radius 6 and 1% noise, up to 1.16 of it.
    rng = np.random.default_rng(3)
    centre = np.array([19.2, 18.9])
    clean = disc(centre, 6.0)
    errors = []
    for _ in range(150):
        picture = (clean + rng.normal(0, 0.01 * STEP, clean.shape)).astype(np.float32)
        fit = fit_edge(picture, centre, np.eye(2) * 36.0, 0.0, 2.5)
        assert fit is not None
        errors.append(fit.centre - centre)
    assert np.std(errors) < 1.16 * 0.0057


def test_noise_tied_between_pixels_widens_the_covariance() -> None:
    rng = np.random.default_rng(5)
    fits, errors = [], []
    for _ in range(80):
        centre = 25 + rng.uniform(-0.5, 0.5, 2)
        clean = disc(centre, 12.0)
        white = rng.normal(0, 4, clean.shape)
        tied = (white + np.roll(white, 1, 0) + np.roll(white, 1, 1) + np.roll(white, (1, 1), (0, 1))) / 2
        fit = fit_edge((clean + tied).astype(np.float32), centre, np.eye(2) * 144.0, 0.0, 2.5)
        assert fit is not None
        fits.append(fit)
        errors.append(fit.centre - centre)
    factor = noise_factor([fit.scatter for fit in fits])
    chi2 = sum(
        float(e @ np.linalg.solve(f.covariance * factor, e)) for e, f in zip(errors, fits, strict=True)
    )
    assert factor > 1.8
    assert (
        abs(chi2 - 160) < 0.4 * 160
    )  # pooled over 80 dots; without the factor it is 2.5 to 3.5 times as large


def test_the_hole_of_a_ring_does_not_pull_the_centre() -> None:
    centre = np.array([25.3, 24.6])
    picture = disc(centre, 12.0, hole=0.4)
    picture[20:24, 22:27] += 60  # dirt in the hole and beside it
    fit = fit_edge(picture.astype(np.float32), centre + 0.2, np.eye(2) * 144.0, 0.4, 2.5)
    assert fit is not None
    assert np.abs(fit.centre - centre).max() < 0.01


def test_dirt_beside_a_dot_is_left_out() -> None:
    centre = np.array([25.3, 24.6])
    picture = disc(centre, 12.0)
    picture[8:10, 20:34] = 20.0
    fit = fit_edge(picture.astype(np.float32), centre + 0.2, np.eye(2) * 144.0, 0.0, 2.5)
    assert fit is not None
    assert np.abs(fit.centre - centre).max() < 0.02


def test_nothing_to_fit() -> None:
    rng = np.random.default_rng(2)
    noise = rng.normal(100, 5, (40, 40)).astype(np.float32)
    fit = fit_edge(noise, np.array([20.0, 20.0]), np.eye(2) * 36.0, 0.0, 1.5)
    assert fit is None or fit.covariance[0, 0] > 0.01
