"""The check of a calibration: a verdict, what has changed, what it costs, what could have been found."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from enum import StrEnum
from typing import TYPE_CHECKING

import numpy as np

from labcal.calibrate.validity.change import ChangeKind
from labcal.calibrate.validity.power import Sensitivity, sensitivities
from labcal.calibrate.validity.tested import Tested, tested, tested_by_marks
from labcal.cameras.rig import Rig, contradiction_note
from labcal.correspond.detections import Detections
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.guide.found_change import FoundChange
from labcal.guide.smallest_change import SmallestChange
from labcal.guide.volume_cost import Volume
from labcal.public_object import HtmlTable, PublicObject
from labcal.targets.catalogue import AnyTarget
from labcal.targets.places import DotPlaces
from labcal.wording import counted

if TYPE_CHECKING:
    import pandas

LIKELY = 0.95
"""Probability from which on a camera or a kind of change is named."""
_WORTH_A_LINE = 0.01
FEWEST_VIEWS = 3
_NOISY = 1.5
_TIMES_BUDGET = 3.0
_ELEMENTARY = (ChangeKind.TURNED, ChangeKind.SHIFTED, ChangeKind.MOVED, ChangeKind.REFOCUSED)


class CheckVerdict(StrEnum):
    """Verdicts on a calibration."""

    VALID = "valid"
    """No change is found, and one that costs more than three sigmas of the budget would have been."""
    CHANGED = "changed"
    CANNOT_TELL = "cannot-tell"
    """No change is found, but these pictures could have missed one that matters."""


@dataclass(frozen=True)
class ChangeCost:
    """Errors of points over the volume if the old rig is used, in the world of the first camera, mm.

    Attributes
    ----------
    rms_mm, max_mm : float
    low_mm, high_mm : tuple of float
        Corners of the volume: that of the target's dots in these pictures.
    """

    rms_mm: float
    max_mm: float
    low_mm: tuple[float, ...]
    high_mm: tuple[float, ...]


@dataclass(frozen=True, eq=False, repr=False)
class RigCheck(PublicObject):
    """The result of checking a rig by new pictures of a target.

    Attributes
    ----------
    verdict : CheckVerdict
    p_value : float
        Probability that noise and the calibration's errors make a difference so large; a change is reported
        up to 0.01.
    changes : tuple of FoundChange
        Explanations by the most likely change first; of a valid rig, what it would be if there were one.
    by_camera : mapping of str to float
        Probability that each camera is the one, given that there is a change.
    cost : ChangeCost or None
        Of the most likely change; None of a rig that is not changed, or of one camera.
    budget_mm : float or None
        RMS standard deviation of a point over the same volume by noise and calibration.
    undetected_mm : float or None
        RMS error of points by the worst change that would be missed once in ten checks.
    smallest : tuple of SmallestChange
        Smallest changes that would be found nine times in ten.
    sigma0 : float
        Residuals over what calibration and covariances predict, where every camera may have changed.
    views : tuple of str
    dots, outliers : int
        Dots that entered; dots that did not, since they are off by themselves.
    warnings : tuple of str
    rig : Rig
        As it was calibrated.
    tested : Tested
        The explanations that were compared.

    Examples
    --------
    >>> from labcal import check, examples, pipeline
    >>> rig = pipeline.calibrate(examples.TARGET, examples.detections()).found.rig
    >>> check(rig, examples.detections(), examples.TARGET).verdict.value
    'valid'
    """

    verdict: CheckVerdict
    p_value: float
    changes: tuple[FoundChange, ...]
    by_camera: Mapping[str, float]
    cost: ChangeCost | None
    budget_mm: float | None
    undetected_mm: float | None
    smallest: tuple[SmallestChange, ...]
    sigma0: float
    views: tuple[str, ...]
    dots: int
    outliers: int
    warnings: tuple[str, ...]
    rig: Rig
    tested: Tested

    @property
    def camera(self) -> str | None:
        """The camera that changed, where that can be determined; None where it cannot, or nothing changed."""
        if self.verdict is not CheckVerdict.CHANGED:
            return None
        likely = [name for name, probability in self.by_camera.items() if probability >= LIKELY]
        return likely[0] if len(likely) == 1 else None

    def mended(self) -> Rig:
        """Return the rig with the change corrected, and its covariance.

        Raises
        ------
        InputError
            Nothing has changed, or these pictures do not support a correction.
        """
        from labcal.guide.mend import mended_rig  # noqa: PLC0415 -- it takes checks

        return mended_rig(self)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each explanation: kind, cameras, probability and p-value.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        from labcal.extras import optional_module  # noqa: PLC0415 -- pandas is optional

        rows = [
            {
                "kind": one.kind.value,
                "cameras": " or ".join(one.cameras),
                "probability": one.probability,
                "p_value": one.p_value,
            }
            for one in self.changes
        ]
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(rows)
        return frame

    def _summary(self) -> Mapping[str, object]:
        summary: dict[str, object] = {"verdict": self.verdict.value, "p_value": f"{self.p_value:.2g}"}
        if self.verdict is CheckVerdict.CHANGED:
            summary["change"] = self.changes[0].words
        if self.cost is not None:
            summary["cost"] = f"{self.cost.rms_mm:.3g} mm"
        return {**summary, "views": len(self.views)}

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [[one.words, f"{one.probability:.2f}", f"{one.p_value:.2g}"] for one in self.changes]
        return [HtmlTable(("change", "probability", "p-value"), rows)]


def checked(rig: Rig, detections: Detections, target: AnyTarget | DotPlaces) -> RigCheck:
    """Check a rig by dots of new pictures of a target.

    Parameters
    ----------
    rig : Rig
    detections : Detections
    target : AnyTarget or DotPlaces

    Raises
    ------
    InputError
        As of :func:`~labcal.calibrate.validity.tested.tested`.
    """
    return _judged(rig, tested(rig, detections, target))


def checked_by_marks(rig: Rig, pixels: NamedPixels, places: NamedPoints) -> RigCheck:
    """Check a rig by new pictures of marks that stay where they are.

    Parameters
    ----------
    rig : Rig
    pixels : NamedPixels
        Of marks in new pictures, with covariances.
    places : NamedPoints
        The marks as this rig measured them before.

    Raises
    ------
    InputError
        As of :func:`~labcal.calibrate.validity.tested.tested_by_marks`.
    """
    return _judged(rig, tested_by_marks(rig, pixels, places))


def _judged(rig: Rig, found: Tested) -> RigCheck:
    """Return verdict, costs and power of a test."""
    made = found.made
    names = made.camera_names
    noise = np.median(made.views.observations.covariance, axis=0)
    volume = Volume.of(rig, found.unchanged.evidence.state, noise)
    power = sensitivities(found)
    budget = None if volume is None else volume.budget_mm()
    undetected = None if volume is None else _undetected(volume, power)
    verdict = _verdict(found, budget, undetected)
    order = np.argsort(-found.probabilities, kind="stable").tolist()
    changes = tuple(
        FoundChange.of(found.changed[i], float(found.probabilities[i]), float(found.p_values[i]), names)
        for i in order
        if i == order[0] or found.probabilities[i] >= _WORTH_A_LINE
    )
    changed = verdict is CheckVerdict.CHANGED and volume is not None
    return RigCheck(
        verdict=verdict,
        p_value=found.p_value,
        changes=changes,
        by_camera={names[camera]: share for camera, share in found.by_camera.items()},
        cost=_cost(found, volume, order[0]) if changed and volume is not None else None,
        budget_mm=budget,
        undetected_mm=undetected,
        smallest=tuple(one for each in power for one in SmallestChange.of(each, names)),
        sigma0=found.sigma0,
        views=made.names,
        dots=len(made.views.observations),
        outliers=made.outliers,
        warnings=tuple(_warnings(rig, found)),
        rig=rig,
        tested=found,
    )


def _undetected(volume: Volume, power: Sequence[Sensitivity]) -> float:
    """Return the RMS error by the worst of the simple changes that may be missed."""
    square = volume.square_by_parameters()
    return max(one.worst(square) for one in power if one.change.kind in _ELEMENTARY)


def _verdict(found: Tested, budget: float | None, undetected: float | None) -> CheckVerdict:
    if found.is_changed:
        return CheckVerdict.CHANGED
    missed = budget is not None and undetected is not None and not undetected <= _TIMES_BUDGET * budget
    return CheckVerdict.CANNOT_TELL if missed else CheckVerdict.VALID


def _cost(found: Tested, volume: Volume, best: int) -> ChangeCost | None:
    """Return what the most likely change costs, the errors of the calibration left out."""
    one, start = found.changed[best], found.made.calibrated.state
    if one.change is None:
        return None
    errors = volume.errors_mm(found.made.views.rig_cameras(one.change.applied(start, one.size)))
    lengths = np.linalg.norm(errors, axis=1)
    lengths = lengths[np.isfinite(lengths)]
    if len(lengths) == 0:
        return None
    rms = float(np.sqrt((lengths**2).mean()))
    low, high = tuple(volume.low_mm.tolist()), tuple(volume.high_mm.tolist())
    return ChangeCost(rms, float(lengths.max()), low, high)


def _warnings(rig: Rig, found: Tested) -> list[str]:
    """Return what a person should not miss."""
    words = list(found.made.skipped)
    contradiction = contradiction_note(rig)
    if contradiction is not None:
        words.append(contradiction)
    views = set(found.made.names) & set(rig.calibrated_on)
    if views:
        words.append(
            f"the rig was calibrated on {counted(len(views), 'view')} named as these are: pictures that a "
            "calibration was made from are no check of it"
        )
    if len(found.made.names) < FEWEST_VIEWS and not found.made.marks:
        words.append(
            f"only {counted(len(found.made.names), 'view')} entered: take {FEWEST_VIEWS} or more, with "
            "different tilts, all over the volume"
        )
    if found.sigma0 > _NOISY:
        words.append(
            f"residuals are {found.sigma0:.2g} times what the calibration predicts, whatever changed: blur, "
            "motion between the exposures, another print, or a lens that is not the calibrated one. The "
            "test allows for it, and finds less"
        )
    return words
