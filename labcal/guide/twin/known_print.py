"""The print as it is known: each dot at its own place, in the plane and in height."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.targets.grid import DotGrid


@dataclass(frozen=True)
class KnownPrint:
    """A print that can be rendered.

    Attributes
    ----------
    target : DotGrid
        With the diameters of dots as they are printed.
    dots : float64 array, (dots, 3)
        Places of the dots, mm: as declared, or as a calibration found them.
    """

    target: DotGrid
    dots: Vectors3

    @property
    def is_measured(self) -> bool:
        """True if any dot is not at its declared place."""
        return bool(self.displacement.any())

    @property
    def displacement(self) -> Float64[np.ndarray, "dots 3"]:
        """Places minus declared places, mm."""
        return np.asarray(self.dots - self.target.points())

    @property
    def rms_um(self) -> float:
        """RMS displacement in the plane, a dot, micrometres."""
        return 1e3 * float(np.sqrt((self.displacement[:, :2] ** 2).sum(axis=1).mean()))

    def shifts_from(self, eye: Float64[np.ndarray, "3"]) -> tuple[tuple[float, float], ...]:
        """Return the shifts of dots in the plane of the board as one point sees them, mm; empty for none.

        Parameters
        ----------
        eye : ndarray, shape (3,)
            In the target's frame, mm.

        Notes
        -----
        A dot that lies higher or lower is seen where its line of sight meets the plane.
        """
        if not self.is_measured:
            return ()
        z = self.dots[:, 2:]
        in_plane = self.displacement[:, :2] + (self.dots[:, :2] - eye[:2]) * z / (eye[2] - z)
        return tuple((float(x), float(y)) for x, y in in_plane)

    def grown(self, growth_mm: float) -> "KnownPrint":
        """Return the print with dots whose radii are larger by so much, and holes of rings smaller, mm."""
        target, more = self.target, 2.0 * growth_mm
        outer, inner = target.ring_outer_diameter_mm, target.ring_inner_diameter_mm
        changed = {
            "dot_diameter_mm": max(target.dot_diameter_mm + more, 0.1 * target.dot_diameter_mm),
            "ring_outer_diameter_mm": None if outer is None else outer + more,
            "ring_inner_diameter_mm": None if inner is None else max(inner - more, 0.1 * inner),
        }
        return KnownPrint(target.model_copy(update=changed), self.dots)
