"""Boxes in which points are trained on and measured."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3

PLANES, COLS, ROWS = 4, 13, 10


@dataclass(frozen=True)
class Volume:
    """A box, mm."""

    low: tuple[float, float, float]
    high: tuple[float, float, float]

    def planes(self, cols: int = COLS, rows: int = ROWS) -> Vectors3:
        """Return the dots of four planes across z, the box's faces included, (4 cols rows, 3)."""
        x, y = np.meshgrid(
            np.linspace(self.low[0], self.high[0], cols), np.linspace(self.low[1], self.high[1], rows)
        )
        heights = np.linspace(self.low[2], self.high[2], PLANES)
        return np.concatenate([np.stack([x.ravel(), y.ravel(), np.full(x.size, z)], axis=1) for z in heights])

    def points(self, count: int, random: np.random.Generator) -> Vectors3:
        """Return random points, (count, 3)."""
        return random.uniform(self.low, self.high, (count, 3))

    def towards(self, other: "Volume", share: float) -> "Volume":
        """Return the box between this one (share 0) and another (share 1)."""
        low, high = (
            tuple(a * (1.0 - share) + b * share for a, b in zip(own, its, strict=True))
            for own, its in ((self.low, other.low), (self.high, other.high))
        )
        return Volume((low[0], low[1], low[2]), (high[0], high[1], high[2]))

    def enlarged(self, margin: float) -> "Volume":
        """Return the box with a margin on each side, as a share of that side's length."""
        low, high = np.array(self.low), np.array(self.high)
        reach = margin * (high - low)
        x, y, z = (low - reach).tolist()
        to_x, to_y, to_z = (high + reach).tolist()
        return Volume((x, y, z), (to_x, to_y, to_z))


TABLE = Volume((650.0, 650.0, 0.0), (1350.0, 1350.0, 1000.0))
"""The paper's volume, seen from 1.4 to 2.9 m."""
ROOM = Volume((-2500.0, -1500.0, 0.0), (4500.0, 3500.0, 1000.0))
"""Volume that fills the picture of a fisheye camera at the same place."""
