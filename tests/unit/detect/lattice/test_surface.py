"""The distance of a grid from one smooth surface, by normal equations, is that of the exact solution."""

import numpy as np

from labcal.detect.lattice.surface import off_smooth_surface
from labcal.geometry.projective_map import projective_map

DEGREE = 4


def scaled_nodes() -> np.ndarray:
    nodes = np.stack(np.meshgrid(np.arange(14.0), np.arange(11.0), indexing="ij"), axis=-1).reshape(-1, 2)
    return np.asarray((nodes - nodes.mean(axis=0)) / 13.0)


def seen_of(nodes: np.ndarray) -> np.ndarray:
    """Return pixels of nodes through perspective and a lens with distortion."""
    x, y = nodes.T
    flat = np.stack([x, y], axis=1) / (1.0 + 0.3 * x - 0.2 * y)[:, None]
    return np.asarray(640.0 + 700.0 * flat * (1.0 - 0.2 * (flat**2).sum(axis=1, keepdims=True)))


def exact(nodes: np.ndarray, seen: np.ndarray) -> float:
    back = projective_map("test", seen, nodes)
    straight = np.concatenate([seen, np.ones((len(seen), 1))], axis=1) @ back.T
    off = straight[:, :2] / straight[:, 2:]
    powers = [(i, j) for i in range(DEGREE + 1) for j in range(DEGREE + 1 - i)]
    design = np.stack([nodes[:, 0] ** i * nodes[:, 1] ** j for i, j in powers], axis=1)
    left = off - design @ np.linalg.lstsq(design, off, rcond=None)[0]
    return float(np.linalg.norm(left, axis=1).max())


def test_as_by_orthogonal_factors() -> None:
    nodes, random = scaled_nodes(), np.random.default_rng(3)
    for noise in (0.0, 0.05, 5.0):
        seen = seen_of(nodes) + noise * random.normal(size=nodes.shape)
        np.testing.assert_allclose(off_smooth_surface(nodes, seen, DEGREE), exact(nodes, seen), rtol=1e-6)


def test_a_row_that_is_linked_one_step_off_is_no_smooth_surface() -> None:
    nodes = scaled_nodes()
    other = nodes.copy()
    other[nodes[:, 0] > 0.1, 1] += 1.0 / 13.0
    assert off_smooth_surface(nodes, seen_of(nodes), DEGREE) * 13.0 < 0.05
    assert off_smooth_surface(nodes, seen_of(other), DEGREE) * 13.0 > 0.25


def test_spots_on_one_line_tell_nothing() -> None:
    nodes = scaled_nodes()
    line = np.stack([nodes[:, 0] * 50.0, nodes[:, 0] * 20.0], axis=1)
    assert np.isnan(off_smooth_surface(nodes, line, DEGREE))
