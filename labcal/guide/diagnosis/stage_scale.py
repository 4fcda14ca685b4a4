"""The scale of a target by the readings of a stage."""

from dataclasses import dataclass

import numpy as np

from labcal.distributions import f_tail
from labcal.geometry.poses import nearest_rotation, transform
from labcal.guide.diagnosis.evidence import Evidence

_FEWEST = 4
"""Views with readings."""


@dataclass(frozen=True)
class StageScale:
    """Ratio of distances that a stage reads to those that the target's pitch gives.

    Attributes
    ----------
    ratio, sigma : float
    p_value : float
        That a pitch as declared gives such a ratio.
    harm_mm : float
        RMS error of points by it, where the target was.
    """

    ratio: float
    sigma: float
    p_value: float
    harm_mm: float

    @property
    def percent(self) -> float:
        """Relative excess of the pitch, %."""
        return 100.0 * (self.ratio - 1.0)

    @property
    def sigma_percent(self) -> float:
        """Standard deviation of it, %."""
        return 100.0 * self.sigma

    @classmethod
    def of(cls, evidence: Evidence) -> "StageScale | None":
        """Return the scale by the places of the board's middle in the first camera; None without readings.

        Notes
        -----
        A similarity between both sets of places (Umeyama 1991). Its scale is as uncertain as residuals say,
        and as the focal length, which stretches depths.
        """
        nominal = evidence.nominal_poses
        if evidence.model is None or len(nominal) < _FEWEST:
            return None
        camera, views = evidence.model.forms.cameras[0], evidence.model.views
        middle = evidence.target.points().mean(axis=0)
        seen, read = [], []
        for at, T in zip(camera.single.views.tolist(), camera.single.T_cam_target, strict=True):
            if views[at] in nominal:
                seen.append(transform(T, middle))
                read.append(transform(nominal[views[at]], middle))
        if len(seen) < _FEWEST:
            return None
        a, b = np.array(seen), np.array(read)
        about, there = a - a.mean(axis=0), b - b.mean(axis=0)
        R, _ = nearest_rotation(there.T @ about)
        square = float((about**2).sum())
        if not square > 0.0:
            return None
        turned = about @ R.T
        ratio = float((turned * there).sum()) / square
        freedom = max(1, 3 * len(a) - 7)
        rest = float(((there - ratio * turned) ** 2).sum()) / freedom
        lens = camera.result.adjusted.covariance
        focal = float(np.sqrt(max(0.0, lens[0, 0]))) / camera.single.camera.K[0, 0]
        sigma = float(np.hypot(np.sqrt(rest / square), focal))
        p_value = f_tail(((ratio - 1.0) / max(sigma, 1e-12)) ** 2, 1, float(freedom))
        return cls(ratio, sigma, p_value, abs(ratio - 1.0) * float(np.sqrt((a**2).sum(axis=1).mean())))
