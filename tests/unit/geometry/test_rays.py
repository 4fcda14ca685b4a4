import numpy as np

from labcal.geometry.rays import closest_points


def unit(v: np.ndarray) -> np.ndarray:
    return v / np.linalg.norm(v, axis=-1, keepdims=True)


def test_rays_meet_where_they_were_aimed() -> None:
    rng = np.random.default_rng(1)
    origins = rng.normal(size=(50, 3, 3)) * 300
    p = rng.normal(size=(50, 3)) * 100 + [0, 0, 2000]
    found = closest_points(origins, unit(p[:, None] - origins))
    np.testing.assert_allclose(found, p, atol=1e-7)


def test_skew_rays_meet_half_way() -> None:
    origins = np.array([[[0.0, 0, 0], [5.0, -7, 4]]])
    directions = np.array([[[1.0, 0, 0], [0.0, 1, 0]]])
    np.testing.assert_allclose(closest_points(origins, directions), [[5, 0, 2]], atol=1e-12)


def test_parallel_and_missing_rays_have_no_point() -> None:
    origins = np.zeros((3, 2, 3))
    origins[:, 1, 0] = 100.0
    directions = np.zeros((3, 2, 3))
    directions[..., 2] = 1.0
    directions[1, 0] = np.nan
    directions[2, 1] = [-0.6, 0, 0.8]
    found = closest_points(origins, directions)
    assert np.isnan(found[:2]).all()
    np.testing.assert_allclose(found[2], [0, 0, 400 / 3], atol=1e-9)
