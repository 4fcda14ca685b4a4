"""Triangulation residuals of dots, which reveal moved cameras and wrong dots."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64

from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import TriangulatedPoints, triangulate
from labcal.correspond.matching import Matches
from labcal.distributions import chi2_quantile, chi2_upper_quantile

MOST_PX = 1.0
"""Median residual beyond which noise is no explanation: the cameras have changed or are others."""
OUTLYING = 1e-6
"""Probability of a residual by noise below which a point is an outlier."""


@dataclass(frozen=True)
class TriangulationResiduals:
    """Triangulation residuals; infinite if the rays do not intersect in front of the cameras."""

    px: Float64[np.ndarray, " n"]
    """Root mean square over the cameras of the 2-D distance."""
    chi_square: Float64[np.ndarray, " n"]
    """The same weighed by the pixels' covariances, summed; 2 x cameras - 3 degrees of freedom."""
    freedom: int

    @classmethod
    def of(cls, cameras: Sequence[Camera], matches: Matches) -> "TriangulationResiduals":
        """Return the residuals of matched dots; cameras in the order of the matches."""
        return cls.at(cameras, matches, triangulate(cameras, matches.q, matches.covariance))

    @classmethod
    def at(
        cls, cameras: Sequence[Camera], matches: Matches, found: TriangulatedPoints
    ) -> "TriangulationResiduals":
        """Return the residuals of matched dots that are triangulated already."""
        px, chi_square = np.full(len(matches), np.inf), np.full(len(matches), np.inf)
        q = np.stack([camera.project(found.point[found.ok]).q for camera in cameras], axis=1)
        off = q - matches.q[found.ok]
        weighed = np.linalg.solve(matches.covariance[found.ok], off[..., None])[..., 0]
        px[found.ok] = np.sqrt((off**2).sum(axis=2).mean(axis=1))
        chi_square[found.ok] = (off * weighed).sum(axis=(1, 2))
        return cls(px, chi_square, 2 * len(cameras) - 3)

    @property
    def typical_px(self) -> float:
        """The median residual, px."""
        return float(np.median(self.px))

    @property
    def outlying(self) -> Bool[np.ndarray, " n"]:
        """Mask of dots whose residual exceeds the noise of their covariances and that of all dots."""
        typical = float(np.median(self.chi_square)) / chi2_quantile(0.5, self.freedom)
        return np.asarray(self.chi_square > max(1.0, typical) * chi2_upper_quantile(OUTLYING, self.freedom))
