from collections.abc import Callable

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.estimators.dlt import Dlt

View = Callable[[np.ndarray], np.ndarray]


def test_exact_for_pinhole_cameras(
    stereo: View, three_cameras: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    for view in (stereo, three_cameras):
        found = Dlt().fit(view(volume), volume).predict(view(other_volume))
        np.testing.assert_allclose(found, other_volume, atol=1e-6)


def test_six_points_suffice(stereo: View, volume: np.ndarray, other_volume: np.ndarray) -> None:
    found = Dlt().fit(stereo(volume[:6]), volume[:6]).predict(stereo(other_volume))
    np.testing.assert_allclose(found, other_volume, atol=1e-6)


def test_projections_reproject_and_give_the_depth(stereo: View, volume: np.ndarray) -> None:
    fitted = Dlt().fit(stereo(volume), volume)
    projected = np.column_stack((volume, np.ones(300))) @ fitted.projections_[0].T
    np.testing.assert_allclose(projected[:, :2] / projected[:, 2:], stereo(volume)[:, :2], atol=1e-8)
    centre, middle = np.array([600.0, 1000.0, 2100.0]), np.array([1000.0, 1000.0, 200.0])
    axis = (middle - centre) / np.linalg.norm(middle - centre)
    np.testing.assert_allclose(projected[:, 2], (volume - centre) @ axis, rtol=1e-9)


def test_noise_stays_near_what_triangulation_allows(
    stereo: View, volume: np.ndarray, other_volume: np.ndarray
) -> None:
    random = np.random.default_rng(8)
    noisy = stereo(volume) + 0.05 * random.standard_normal((300, 4))
    seen = stereo(other_volume)
    seen_noisy = seen + 0.05 * random.standard_normal(seen.shape)
    exact = Dlt().fit(stereo(volume), volume)
    fitted, limit = (
        np.sqrt(np.mean(np.sum((method.predict(seen_noisy) - other_volume) ** 2, axis=1)))
        for method in (Dlt().fit(noisy, volume), exact)
    )
    assert limit < fitted < 1.15 * limit


def test_one_plane_is_refused(stereo: View, plane: np.ndarray) -> None:
    with pytest.raises(InputError, match=r"on one plane.*'homography'"):
        Dlt().fit(stereo(plane), plane)
    tilted = plane + 0.3 * (plane[:, :1] - 1000.0) * np.array([0.0, 0.0, 1.0])
    with pytest.raises(InputError, match="on one plane"):
        Dlt().fit(stereo(tilted), tilted)


def test_degenerate_input_is_refused(stereo: View, plane: np.ndarray, volume: np.ndarray) -> None:
    with pytest.raises(InputError, match="5 points were given, but at least 6"):
        Dlt().fit(stereo(volume[:5]), volume[:5])
    line = np.linspace((700, 700, 100), (1300, 1000, 500), 30)
    with pytest.raises(InputError, match="on one line"):
        Dlt().fit(stereo(line), line)
    with pytest.raises(InputError, match="one camera"):
        Dlt().fit(stereo(volume)[:, :2], volume)
    with pytest.raises(InputError, match="two a camera"):
        Dlt().fit(stereo(volume)[:, :3], volume)
    # A plane and a single dot off it still leave the camera open.
    almost = np.vstack((plane, [[1000.0, 1000.0, 600.0]]))
    with pytest.raises(InputError, match="undetermined"):
        Dlt().fit(stereo(almost), almost)
    same = stereo(volume)
    same[:, :2] = 100.0
    with pytest.raises(InputError, match="same pixel"):
        Dlt().fit(same, volume)
