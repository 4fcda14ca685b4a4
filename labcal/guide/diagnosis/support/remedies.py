"""Errors to expect with the views of a shoot, and with those it could have had."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Pose
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.guide.diagnosis.support.expected_error import SupportedRig
from labcal.guide.diagnosis.support.supposed_views import spread_views, tilted_views

ENOUGH_VIEWS = 12
"""Views from which on more of the same kind hardly lower the error, where they tilt and cover."""

FEW_VIEWS = 6
"""Views below which chance alone decides whether they tilt and cover."""


@dataclass(frozen=True)
class Remedies:
    """RMS 3-D errors over what the cameras see, mm: as the shoot is, and as it could have been.

    Infinite where views do not determine the cameras.

    Attributes
    ----------
    views : int
    now : float
    tilted, spread, both : float
        With as many views that are tilted, spread over the pictures, or both.
    enough : float
        With :data:`ENOUGH_VIEWS` views (or as many as there are) that are tilted and spread.
    """

    views: int
    now: float
    tilted: float
    spread: float
    both: float
    enough: float

    @classmethod
    def of(cls, found: HandheldCalibration) -> "Remedies":
        """Return the errors for a calibration."""
        rig, poses = SupportedRig.of(found), [np.asarray(T) for T in found.T_world_target]
        tilted = tilted_views(poses, rig.dots.mean(axis=0))
        both = _error(rig, spread_views(rig, tilted))
        many = [poses[number % len(poses)] for number in range(max(ENOUGH_VIEWS, len(poses)))]
        enough = spread_views(rig, tilted_views(many, rig.dots.mean(axis=0)))
        return cls(
            views=len(poses),
            now=_error(rig, poses),
            tilted=_error(rig, tilted),
            spread=_error(rig, spread_views(rig, poses)),
            both=both,
            enough=both if len(poses) >= ENOUGH_VIEWS else _error(rig, enough),
        )

    @property
    def are_few(self) -> bool:
        """True if views are so few that more of them are the mend of all that they lack."""
        return self.views < FEW_VIEWS

    @property
    def by_views(self) -> float:
        """Relative increase of the error by too few views.

        Of very few ones all that they lack counts; of more the part that the best of their number would have.
        """
        return _increase(self.now if self.are_few else self.both, self.enough)

    @property
    def by_tilt(self) -> float:
        """Relative increase of the error by too little tilt, beside what places do."""
        return _alone((self.now, self.tilted, self.spread, self.both))

    @property
    def by_places(self) -> float:
        """Relative increase of the error by places, beside what tilts do."""
        return _alone((self.now, self.spread, self.tilted, self.both))


def _alone(errors: tuple[float, float, float, float]) -> float:
    """Return what a remedy brings: after the other one where that brings more.

    `errors` are those now, with the remedy, with the other one, and with both.
    """
    now, mended, other, both = errors
    return _increase(now, mended) if mended <= other else _increase(other, both)


def _increase(error: float, better: float) -> float:
    if not np.isfinite(error):
        return float("inf") if np.isfinite(better) else 0.0
    return max(0.0, error / better - 1.0) if np.isfinite(better) else 0.0


def _error(rig: SupportedRig, poses: list[Pose]) -> float:
    parts = rig.errors(poses)
    return float("inf") if parts is None else parts.rms_mm()
