"""The test of a calibration against new views: changes beyond noise and the calibration's errors."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.calibrate.validity.change import ALL_CAMERAS, Change, ChangeKind
from labcal.calibrate.validity.explanation import Explanation, explained
from labcal.calibrate.validity.prepared import Prepared, cleaned, prepared
from labcal.calibrate.validity.prepared_marks import cleaned_marks, prepared_by_marks
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.distributions import gain_tail
from labcal.errors import InputError
from labcal.run.threads import one_blas_thread
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces

ALARM = 0.01
"""Probability of a false alarm, all kinds of changes together."""
WITH_AXES = (ChangeKind.TURNED, ChangeKind.SHIFTED)
"""Kinds that are tested along each axis of the camera by itself, too."""


@dataclass(frozen=True)
class Tested:
    """New views explained by the rig as it was calibrated, and by every kind of change.

    Attributes
    ----------
    made : Prepared
    unchanged : Explanation
    changed : tuple of Explanation
        Those that image all dots, in the order of their changes.
    """

    made: Prepared
    unchanged: Explanation
    changed: tuple[Explanation, ...]

    @property
    def p_values(self) -> Float64[np.ndarray, " changes"]:
        """Probability that errors alone let each change explain so much (likelihood ratio; Wilks 1938).

        Where the noise of views is known by their own disagreement, an F distribution takes the place of the
        chi-square.
        """
        gains = [max(0.0, self.unchanged.cost - one.cost) for one in self.changed]
        counts = [0 if one.change is None else one.change.count for one in self.changed]
        pairs = zip(gains, counts, strict=True)
        return np.array([gain_tail(gain, count, self.made.noise_freedom) for gain, count in pairs])

    @property
    def axis_p_values(self) -> Float64[np.ndarray, " axes"]:
        """The same of turns and shifts along one axis of a camera alone, which most knocks are nearly."""
        gains = [gain for one in self.changed if _has_axes(one) for gain in one.axis_gains().tolist()]
        return np.array([gain_tail(gain, 1, self.made.noise_freedom) for gain in gains])

    @property
    def p_value(self) -> float:
        """The least of all times their number (Bonferroni; the first step of Holm 1979), at most 1."""
        both = np.concatenate([self.p_values, self.axis_p_values])
        return min(1.0, len(both) * float(both.min()))

    @property
    def is_changed(self) -> bool:
        """True if the rig has changed, with a false alarm but once in :data:`ALARM` checks."""
        return self.p_value <= ALARM

    @property
    def probabilities(self) -> Float64[np.ndarray, " changes"]:
        """Posterior probability of each change, given that there is one; before, all are as likely."""
        logs = np.array([one.log_evidence for one in self.changed])
        weights = np.exp(logs - logs.max())
        return np.asarray(weights / weights.sum())

    @property
    def by_camera(self) -> dict[int, float]:
        """Posterior probability that each camera is the one that changed; of several changes, for each."""
        found = dict.fromkeys(self.made.cameras, 0.0)
        for one, probability in zip(self.changed, self.probabilities.tolist(), strict=True):
            change = _change_of(one)
            each = 1.0 if change.kind in ALL_CAMERAS else 1.0 / len(change.suspects)
            for camera in change.suspects:
                found[camera] += each * probability
        return found

    @property
    def sigma0(self) -> float:
        """Residuals over what is stated of them, where every camera may have changed."""
        return float(np.sqrt(self.made.excess))


@one_blas_thread()
def tested(rig: Rig, detections: Detections, target: AnyTarget | DotPlaces) -> Tested:
    """Test a rig against new views of a target.

    Parameters
    ----------
    rig : Rig
        With the covariance of its calibration.
    detections : Detections
        Centroids.
    target : AnyTarget or DotPlaces

    Raises
    ------
    InputError
        As of :func:`~labcal.calibrate.validity.prepared.prepared`; or no rig explains the dots.
    """
    made = prepared(rig, detections, target)
    anything = made.views.changes(made.cameras)[-1]
    return _compared(*cleaned(made, anything))


@one_blas_thread()
def tested_by_marks(rig: Rig, pixels: NamedPixels, places: NamedPoints) -> Tested:
    """Test a rig against new pictures of marks that stay where they are.

    Parameters
    ----------
    rig : Rig
        With the covariance of its calibration.
    pixels : NamedPixels
        Of marks in new pictures.
    places : NamedPoints
        The marks as this rig measured them before.

    Raises
    ------
    InputError
        As of :func:`~labcal.calibrate.validity.prepared_marks.prepared_by_marks`; or no rig explains them.
    """
    made = prepared_by_marks(rig, pixels, places)
    anything = made.views.changes(made.cameras)[-1]
    return _compared(*cleaned_marks(made, anything))


def _compared(made: Prepared, widest: Explanation) -> Tested:
    """Return the explanations by no change, by every kind, and by the widest one, which is known."""
    unchanged = explained(made.calibrated, None, made.views, widest.cost)
    if unchanged is None:
        raise InputError("The rig as it was calibrated images not all that these pictures show.")
    found = [
        explained(made.calibrated, change, made.views, widest.cost, unchanged.errors)
        for change in made.views.changes(made.cameras)[:-1]
    ]
    return Tested(made, unchanged, (*(one for one in found if one is not None), widest))


def tests_of(changes: tuple[Change, ...]) -> int:
    """Return the number of tests of some kinds of changes: each of its own, and those of single axes."""
    return len(changes) + sum(change.count for change in changes if change.kind in WITH_AXES)


def _has_axes(one: Explanation) -> bool:
    """Return whether a change is tested along each axis, too."""
    return one.change is not None and one.change.kind in WITH_AXES


def _change_of(one: Explanation) -> Change:
    """Return the change of an explanation that has one."""
    if one.change is None:
        raise TypeError("This explanation is that of no change.")
    return one.change
