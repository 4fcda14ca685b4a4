"""Sums of residuals by harmonic: of white noise they have the power that is expected."""

import numpy as np
import pytest
from scipy.special import ndtr

import labcal.detect.edges.outline_noise as module
from labcal.detect.edge_fit import fit_edges
from labcal.detect.edges.residuals import VARIANCE
from labcal.detect.outlines.outlines import Outlines

ROWS, COLS, BLUR, NOISE = 10, 12, 0.8, 3.0


def noisy_discs(radius: float, seed: int) -> tuple[np.ndarray, Outlines]:
    """Return a picture of round discs with edges that are error functions, and where to begin."""
    rng, side = np.random.default_rng(seed), int(4 * radius) + 4
    picture, centre = np.empty((ROWS * side, COLS * side), dtype=np.float32), []
    for row in range(ROWS):
        for col in range(COLS):
            x, y = (col + 0.5) * side + rng.uniform(-1, 1), (row + 0.5) * side + rng.uniform(-1, 1)
            X, Y = np.meshgrid(
                np.arange(col * side, (col + 1) * side), np.arange(row * side, (row + 1) * side)
            )
            light = 200.0 - 150.0 * ndtr((radius - np.hypot(X - x, Y - y)) / BLUR)
            picture[row * side : (row + 1) * side, col * side : (col + 1) * side] = light
            centre.append((x, y))
    picture += rng.normal(0.0, NOISE, picture.shape).astype(np.float32)
    n = len(centre)
    shape = np.tile(np.eye(2) * radius**2, (n, 1, 1))
    return picture, Outlines(np.array(centre), shape, np.zeros(n), np.full(n, BLUR))


@pytest.mark.parametrize("radius", [5.0, 9.0, 17.0])
def test_white_noise_has_the_power_that_is_expected(radius: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """The third harmonic of small dots is partly taken by the fit; 9 px: by more than half."""
    seen, expected, tables = [], [], []
    plain = module.harmonic_sums

    def kept(table, *rest):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN002, ANN202 -- as it is called
        sums = plain(table, *rest)
        seen.append((sums[..., :2] ** 2).sum(axis=2))
        expected.append(sums[..., 2].copy())
        tables.append(table[:, VARIANCE])
        return sums

    monkeypatch.setattr(module, "harmonic_sums", kept)
    for seed in range(4):
        picture, spots = noisy_discs(radius, seed)
        fit_edges(picture, spots, np.zeros(len(spots.centre)), 1.8)
    variance = np.concatenate(tables)
    assert abs(variance.mean() / NOISE**2 - 1.0) < 0.02
    powers, means = np.concatenate(seen) / NOISE**2, np.concatenate(expected)
    # Each power is the sum of two squares, half of its mean squared each.
    z = (powers - means).sum(axis=0) / np.sqrt((means**2).sum(axis=0))
    assert np.abs(z).max() < 3.5
    if radius == 9.0:
        assert means[:, 0].mean() < 0.5
    assert (means[:, 1:] == 1.0).all()
