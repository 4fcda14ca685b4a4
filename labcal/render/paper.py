"""The paper of a print on float32 arrays of Dr.Jit: places in the design, and reflectance."""

from dataclasses import dataclass

import drjit as dr
import numpy as np

from labcal.render.variant import Jit
from labcal.scene.print import TruePrint


@dataclass(frozen=True)
class Paper:
    """A print with positions in uv, from 0 to 1 along the edges of the board."""

    made: TruePrint

    def designed(self, uv: Jit) -> tuple[Jit, Jit]:
        """Return the position in the design, mm, of a position on the board."""
        surface = self.made.surface
        (x_middle, y_middle), (width, height) = surface.middle.tolist(), (2.0 * surface.half).tolist()
        x, y = (uv.x - 0.5) * width, (uv.y - 0.5) * height
        if not np.array_equal(self.made.A, np.eye(2)):
            (a, b), (c, d) = np.linalg.inv(self.made.A).tolist()
            x, y = a * x + b * y, c * x + d * y
        x, y = x + x_middle, y + y_middle
        x_scale, y_scale = self.made.scale_x_y.tolist()
        return (x, y) if x_scale == y_scale == 1.0 else (x / x_scale, y / y_scale)

    def evenness(self, uv: Jit) -> Jit:
        """Return the factor of the local unevenness of the paper; 1 for even paper."""
        width, height = (2.0 * self.made.surface.half).tolist()
        factor: Jit = 1.0
        for along_x, along_y, phase in self.made.waves.tolist():
            factor += self.made.amplitude * dr.cos(along_x * width * uv.x + along_y * height * uv.y + phase)
        return factor
