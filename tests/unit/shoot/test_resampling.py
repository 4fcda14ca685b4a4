"""Resampled pictures keep their type and colours, and take values from exact places."""

import numpy as np
import pytest

from labcal.errors import InputError
from labcal.shoot.resampling import resampled


@pytest.mark.parametrize(("dtype", "full"), [(np.uint8, 255), (np.uint16, 65535), (np.float32, 1.0)])
@pytest.mark.parametrize("colour", [False, True])
def test_a_slope_is_met_to_its_rounding(dtype: type, full: float, *, colour: bool) -> None:
    x = np.broadcast_to(np.arange(100.0), (80, 100)) / 100.0 * full
    picture = x.astype(dtype) if dtype is np.float32 else np.rint(x).astype(dtype)
    if colour:
        picture = np.dstack([picture, picture[:, ::-1], 0 * picture])
    places = np.random.default_rng(2).uniform(5.0, 70.0, (40, 60, 2)).astype(np.float32)
    places[3, 4] = np.nan
    places[5, 6] = [1e30, 2.0]
    found = resampled(picture, places)
    assert found.dtype == dtype
    assert found.shape == (40, 60, 3)[: 3 if colour else 2]
    grey = found[..., 0] if colour else found
    inside = np.isfinite(places).all(axis=2) & (places[..., 0] < 100)
    step = 0.0 if dtype is np.float32 else 1.01  # both the old and the new picture are rounded
    expected = places[..., 0] / 100.0 * full
    np.testing.assert_allclose(grey[inside], expected[inside], atol=step + 1e-6 * full)
    assert not np.any(found[~inside])


def test_other_types_and_endless_pictures_are_refused() -> None:
    places = np.zeros((4, 4, 2), dtype=np.float32)
    with pytest.raises(InputError, match="type int32"):
        resampled(np.zeros((4, 4), dtype=np.int32), places)
    with pytest.raises(InputError, match="32767 pixels along a side"):
        resampled(np.zeros((2, 40000), dtype=np.uint8), places)
