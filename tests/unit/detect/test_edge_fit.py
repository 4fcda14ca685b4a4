"""The edge fit against discs with an analytic profile: bias, the stated covariance, and what it refuses."""

import numpy as np
import pytest
from scipy.special import ndtr

from labcal.detect.edge_fit import EdgeFits, fit_edges
from labcal.detect.outlines.outlines import Outlines

STEP = 170.0


def fit(picture: np.ndarray, centre: np.ndarray, radius: float, hole: float = 0.0) -> EdgeFits:
    """Fit the one dot of a picture."""
    return fit_edges(picture.astype(np.float32), spots(centre[None], radius), np.array([hole]), 2.5)


def spots(centre: np.ndarray, radius: float) -> Outlines:
    """Return where to begin: round dots of one size."""
    n = len(centre)
    return Outlines(centre, np.tile(np.eye(2) * radius**2, (n, 1, 1)), np.zeros(n), np.full(n, 1.0))


def sheet(pictures: list[np.ndarray]) -> np.ndarray:
    """Put pictures of one size side by side."""
    return np.concatenate(pictures, axis=1).astype(np.float32)


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
    normed, n, errors, factors = [], 300, [], []
    for k in range(n):
        centre = radius + 13 + rng.uniform(-0.5, 0.5, 2)
        clean = disc(centre, radius)
        start = centre + rng.uniform(-0.3, 0.3, 2)
        found = fit(clean + rng.normal(0, noise, clean.shape), start, radius * 1.05)
        assert found.ok.all()
        errors.append(found.centre[0] - centre)
        factors.append(found.noise_factor)
        covariance = found.covariance[0] / found.noise_factor
        normed.append(np.linalg.solve(np.linalg.cholesky(covariance), errors[-1]))
        if k < 10:
            exact = fit(clean, start, radius * 0.95)
            assert np.abs(exact.centre[0] - centre).max() < 0.002
    chi2 = float((np.array(normed) ** 2).sum())
    dof = 2 * n
    assert abs(chi2 - dof) < 4 * np.sqrt(2 * dof)
    assert np.abs(np.mean(normed, axis=0)).max() < 4 / np.sqrt(n)


def test_standard_deviation_is_near_the_cramer_rao_bound() -> None:
    # DESIGN: 0.0057 px at radius 6 and 1% noise, up to 1.16 of it.
    rng = np.random.default_rng(3)
    centre = np.array([19.2, 18.9])
    clean = disc(centre, 6.0)
    errors = []
    for _ in range(150):
        found = fit(clean + rng.normal(0, 0.01 * STEP, clean.shape), centre, 6.0)
        errors.append(found.centre[0] - centre)
    assert np.std(errors) < 1.16 * 0.0057


def test_noise_tied_between_pixels_widens_the_covariance() -> None:
    rng = np.random.default_rng(5)
    centres = 25 + rng.uniform(-0.5, 0.5, (80, 2))
    discs = [disc(centre, 12.0) for centre in centres]
    centres[:, 0] += np.arange(80) * discs[0].shape[1]
    clean = sheet(discs)
    white = rng.normal(0, 4, clean.shape)
    tied = (white + np.roll(white, 1, 0) + np.roll(white, 1, 1) + np.roll(white, (1, 1), (0, 1))) / 2
    found = fit_edges((clean + tied).astype(np.float32), spots(centres, 12.0), np.zeros(80), 1.9)
    errors = found.centre - centres
    chi2 = float(np.einsum("ni,nij,nj->", errors, np.linalg.inv(found.covariance), errors))
    assert found.noise_factor > 1.8
    # Pooled over 80 dots; without the factor it is 2.5 to 3.5 times as large.
    assert abs(chi2 - 160) < 0.4 * 160


def test_the_hole_of_a_ring_does_not_pull_the_centre() -> None:
    centre = np.array([25.3, 24.6])
    picture = disc(centre, 12.0, hole=0.4)
    picture[20:24, 22:27] += 60  # dirt in the hole and beside it
    found = fit(picture, centre + 0.2, 12.0, hole=0.4)
    assert np.abs(found.centre[0] - centre).max() < 0.01


def test_dirt_beside_a_dot_is_left_out() -> None:
    centre = np.array([25.3, 24.6])
    picture = disc(centre, 12.0)
    picture[8:10, 20:34] = 20.0
    found = fit(picture, centre + 0.2, 12.0)
    assert np.abs(found.centre[0] - centre).max() < 0.02


def test_nothing_to_fit() -> None:
    for seed in range(6):
        rng = np.random.default_rng(seed)
        found = fit(rng.normal(100, 5, (40, 40)), np.array([20.0, 20.0]), 6.0)
        assert not found.ok[0]
        assert np.isnan(found.centre).all()
        assert np.isnan(found.covariance).all()


def _lit_sheet(own_slope: float) -> tuple[np.ndarray, np.ndarray]:
    """Return errors (n, 2) and covariances of small dots side by side whose ink has slopes of its own."""
    rng = np.random.default_rng(11)
    radius, count = 6.0, 150
    centres = radius + 13 + rng.uniform(-0.5, 0.5, (count, 2))
    side = int(2 * radius + 26)
    y, x = np.mgrid[:side, :side]
    discs = []
    for centre in centres:
        clean = disc(centre, radius)
        ink = (200 - clean.clip(30, 200)) / STEP  # how much of a pixel is dot, nearly
        slope = own_slope * STEP * rng.standard_normal(2) / radius
        discs.append(clean + ink * (slope[0] * (x - centre[0]) + slope[1] * (y - centre[1])))
    centres[:, 0] += np.arange(count) * side
    noisy = sheet(discs)
    noisy += rng.normal(0, 0.01 * STEP, noisy.shape).astype(np.float32)
    found = fit_edges(noisy, spots(centres, radius), np.zeros(count), 2.5)
    assert found.ok.all()
    return found.centre - centres, found.covariance


@pytest.mark.parametrize("own_slope", [0.0, 0.03])
def test_dots_in_one_light_are_measured_better_and_those_that_are_not_say_so(own_slope: float) -> None:
    errors, covariance = _lit_sheet(own_slope)
    chi2 = float(np.einsum("ni,nij,nj->", errors, np.linalg.inv(covariance), errors))
    dof = errors.size
    assert abs(chi2 - dof) < 4 * np.sqrt(2 * dof)
    # By itself a dot is known to 0.0045 px.
    rms = np.sqrt((errors**2).mean())
    assert (0.003 < rms < 0.004) if own_slope == 0.0 else (0.004 < rms < 0.005)


@pytest.mark.parametrize("radius", [8.0, 20.0])
def test_an_outline_in_steps_is_measured_as_well_as_it_says(radius: float) -> None:
    rng, normed = np.random.default_rng(5), []
    for _ in range(150):
        centre = radius + 13 + rng.uniform(-0.5, 0.5, 2)
        side = int(2 * radius + 26)
        x, y = np.meshgrid(np.arange(side), np.arange(side))
        hard = np.where((x - centre[0]) ** 2 + (y - centre[1]) ** 2 < radius**2, 40.0, 225.0)
        found = fit(hard + rng.normal(0, 1.0, hard.shape), centre + rng.uniform(-0.3, 0.3, 2), radius)
        if found.ok[0]:
            normed.append(np.linalg.solve(np.linalg.cholesky(found.covariance[0]), found.centre[0] - centre))
    assert len(normed) > 0.9 * 150
    assert 0.6 < np.mean(np.array(normed) ** 2) < 1.5
