"""The pixels around outlines, also of those beyond the picture."""

import numpy as np
import pytest

from labcal.detect.edges.band import pixels_around
from labcal.detect.edges.edge_limits import EdgeLimits
from labcal.detect.stage_settings.edge import EdgeSettings

LIMITS = EdgeSettings().limits(EdgeLimits)
GREY = np.arange(30.0 * 40.0, dtype=np.float32).reshape(30, 40)


def around(x: float, y: float) -> tuple[np.ndarray, int]:
    """Return the pixels around a circle with a radius of 5 px."""
    state = np.zeros(32)
    state[:6] = x, y, 0.2, 0.0, 0.2, 0.8
    return pixels_around(GREY, state, (0.0, 2.0), LIMITS)


def test_pixels_are_those_of_the_picture_that_lie_near() -> None:
    band, of_edge = around(20.0, 14.0)
    assert 0 < of_edge <= band.shape[1]
    col, row = band[:2].astype(int)
    np.testing.assert_array_equal(band[2], GREY[row, col])
    rho = np.hypot(col - 20, row - 14) / 5.0
    assert np.abs(rho[:of_edge] - 1.0).max() < np.abs(rho - 1.0).max()
    assert len(set(zip(col.tolist(), row.tolist(), strict=True))) == band.shape[1]


@pytest.mark.parametrize(("x", "y"), [(-60.0, 14.0), (120.0, 14.0), (20.0, -60.0), (20.0, 120.0)])
def test_an_outline_beyond_the_picture_has_none(x: float, y: float) -> None:
    band, of_edge = around(x, y)
    assert band.shape[1] == of_edge == 0
