"""What several tests use."""

import pytest

from labcal.targets.grid import DotGrid, Rings


@pytest.fixture
def grid() -> DotGrid:
    """A small target with different pitches, so that x and y cannot be exchanged unseen."""
    return DotGrid(
        name="small",
        cols=5,
        rows=4,
        pitch_x_mm=20.0,
        pitch_y_mm=12.5,
        dot_diameter_mm=6.0,
        ring_outer_diameter_mm=8.0,
        ring_inner_diameter_mm=3.0,
        rings=Rings(origin=(1, 0), x=(3, 0), y=(1, 2)),
        margin_mm=10.0,
    )
