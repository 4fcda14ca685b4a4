"""Grey values at which a picture is clipped, without a look at the whole of most pictures."""

import numpy as np
import pytest

from labcal.detect.grey import clipping

SHARE = 0.01


@pytest.mark.parametrize("seed", range(20))
def test_a_picture_is_clipped_where_many_of_its_pixels_have_its_own_extremes(seed: int) -> None:
    random = np.random.default_rng(seed)
    grey = random.normal(100.0, 40.0, (600, 90)).astype(np.float32)
    low, high = random.uniform(0.0, 60.0), random.uniform(140.0, 250.0)
    grey = np.clip(grey, low, high).astype(np.float32)
    if seed % 2:  # one pixel in a row that is not among the sample's is darker than all that are cut off
        grey[1, 5] = low - 1.0
    if seed % 3 == 0:
        grey[301, 7] = high + 1.0
    found = clipping(grey, SHARE)
    for value, extreme, none in zip(found, (grey.min(), grey.max()), (-np.inf, np.inf), strict=True):
        is_clipped = (grey[::3] == extreme).mean() > SHARE
        assert value == (extreme if is_clipped else none)
