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
        return increase(*self.of_views)

    @property
    def of_views(self) -> tuple[float, float]:
        """The errors without and with enough views, of which :attr:`by_views` is the increase."""
        return (self.now if self.are_few else self.both), self.enough

    @property
    def of_tilt(self) -> tuple[float, float]:
        """The errors without and with tilted views; of spread ones, where those bring more."""
        return (self.now, self.tilted) if self.tilted <= self.spread else (self.spread, self.both)

    @property
    def of_places(self) -> tuple[float, float]:
        """The errors without and with views in all places; of tilted ones, where those bring more."""
        return (self.now, self.spread) if self.spread <= self.tilted else (self.tilted, self.both)

    @property
    def by_tilt(self) -> float:
        """Relative increase of the error by too little tilt, beside what places do."""
        return increase(*self.of_tilt)

    @property
    def by_places(self) -> float:
        """Relative increase of the error by places, beside what tilts do."""
        return increase(*self.of_places)


def increase(error: float, better: float) -> float:
    """Return the relative increase of an error beside a better one; infinite where only that is finite."""
    if not np.isfinite(error):
        return float("inf") if np.isfinite(better) else 0.0
    return max(0.0, error / better - 1.0) if np.isfinite(better) else 0.0


def _error(rig: SupportedRig, poses: list[Pose]) -> float:
    parts = rig.errors(poses)
    return float("inf") if parts is None else parts.rms_mm()
