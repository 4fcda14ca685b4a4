"""Check a rig by new views of a target, or of marks that stay in place: verdict, cost, power, warnings."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from labcal.calibrate.validity.change import ChangeKind
from labcal.calibrate.validity.power import Sensitivity, sensitivities
from labcal.calibrate.validity.tested import Tested, tested, tested_by_marks
from labcal.cameras.rig import Rig, contradiction_note
from labcal.correspond.detections import Detections
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.guide.found_change import FoundChange
from labcal.guide.print_difference import PrintDifference
from labcal.guide.rig_check import FEWEST_VIEWS, ChangeCost, CheckVerdict, RigCheck
from labcal.guide.smallest_change import SmallestChange
from labcal.guide.volume_cost import Volume
from labcal.targets.catalogue import AnyTarget
from labcal.targets.kept_target import other_target_note
from labcal.targets.places import DotPlaces
from labcal.wording import counted

_WORTH_A_LINE = 0.01
_NOISY = 1.5
_TIMES_BUDGET = 3.0
_ELEMENTARY = (ChangeKind.TURNED, ChangeKind.SHIFTED, ChangeKind.MOVED, ChangeKind.REFOCUSED)


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
    found = _judged(rig, tested(rig, detections, target))
    shown = target.target if isinstance(target, DotPlaces) else target
    changed = found.verdict is CheckVerdict.CHANGED
    difference = PrintDifference.of(found.tested, shown, changed=changed)
    notes = () if difference is None else difference.words
    other = other_target_note(rig, target)
    notes = notes if other is None else (*notes, other)
    return replace(found, warnings=(*found.warnings, *notes), print_difference=difference)


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
