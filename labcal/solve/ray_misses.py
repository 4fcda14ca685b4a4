"""By how much the rays of a dot miss each other: it tells swapped pictures, moved cameras and wrong dots."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from jaxtyping import Bool, Float64
from scipy.stats import chi2

from labcal.cameras.camera import Camera
from labcal.cameras.triangulation import triangulate
from labcal.correspond.matching import Matches
from labcal.errors import InputError

MOST_PX = 1.0
"""A typical miss beyond this is no noise: the cameras are not as they were, or not these."""
SWAPPED_BETTER = 0.1
"""Pictures are swapped where exchanging them leaves less than this share of the misses."""
OUTLYING = 1e-6
"""A point is no measurement where noise would leave so few as far off."""


@dataclass(frozen=True)
class RayMisses:
    """Reprojection errors of triangulated dots; infinite where the rays meet nowhere before the cameras."""

    px: Float64[np.ndarray, " n"]
    """Root mean square over the cameras of the 2-D distance."""
    chi_square: Float64[np.ndarray, " n"]
    """The same weighed by the pixels' covariances, summed; 2 x cameras - 3 degrees of freedom."""
    freedom: int

    @classmethod
    def of(cls, cameras: Sequence[Camera], matches: Matches) -> "RayMisses":
        """Return those of matched dots; cameras in the order of the matches."""
        found = triangulate(cameras, matches.q, matches.covariance)
        px, chi_square = np.full(len(matches), np.inf), np.full(len(matches), np.inf)
        q = np.stack([camera.project(found.point[found.ok]).q for camera in cameras], axis=1)
        off = q - matches.q[found.ok]
        weighed = np.linalg.solve(matches.covariance[found.ok], off[..., None])[..., 0]
        px[found.ok] = np.sqrt((off**2).sum(axis=2).mean(axis=1))
        chi_square[found.ok] = (off * weighed).sum(axis=(1, 2))
        return cls(px, chi_square, 2 * len(cameras) - 3)

    @property
    def typical_px(self) -> float:
        """The median miss, px."""
        return float(np.median(self.px))

    @property
    def outlying(self) -> Bool[np.ndarray, " n"]:
        """Which dots miss by more than noise explains, that of their covariances or what all of them show."""
        typical = float(np.median(self.chi_square)) / float(chi2.median(self.freedom))
        return np.asarray(self.chi_square > max(1.0, typical) * chi2.isf(OUTLYING, self.freedom))


def refuse_swapped(cameras: Sequence[Camera], matches: Matches) -> None:
    """Raise where pictures bear each other's camera's name.

    Parameters
    ----------
    cameras : sequence of Camera
        In the order of the matches.
    matches : Matches

    Raises
    ------
    InputError
        In a view, the rays of the dots meet far better when two cameras' pictures are exchanged.
    """
    for view in dict.fromkeys(matches.view.tolist()):
        of_view = matches.where(matches.view == view)
        given = RayMisses.of(cameras, of_view).typical_px
        if given <= MOST_PX:
            continue
        for a, b in combinations(range(len(cameras)), 2):
            order = list(range(len(cameras)))
            order[a], order[b] = b, a
            exchanged = replace(of_view, q=of_view.q[:, order], covariance=of_view.covariance[:, order])
            left = RayMisses.of(cameras, exchanged).typical_px
            if left < SWAPPED_BETTER * given:
                one, other = matches.cameras[a], matches.cameras[b]
                raise InputError(
                    f"In view '{view}' the pictures of '{one}' and '{other}' seem to be swapped: exchanged, "
                    f"the rays of a dot miss each other by {left:.3g} px, but as they are "
                    f"{_words(given)}. Say which picture is whose: labcal detect --cameras."
                )


def _words(px: float) -> str:
    return f"by {px:.3g} px" if np.isfinite(px) else "they meet nowhere before the cameras"
