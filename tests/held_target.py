"""A target with rings that is held in the hand, for tests of guided captures."""

from labcal.targets.grid import DotGrid, Rings


def target() -> DotGrid:
    return DotGrid(
        name="held", cols=13, rows=10, pitch_x_mm=18.0, pitch_y_mm=18.0, dot_diameter_mm=8.0,
        ring_outer_diameter_mm=8.0, ring_inner_diameter_mm=3.5, margin_mm=10.0,
        rings=Rings(origin=(3, 3), x=(9, 3), y=(3, 7)),
    )  # fmt: skip
