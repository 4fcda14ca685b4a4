"""A rig with its change corrected: as few parameters as explain the pictures, with a new covariance."""

import numpy as np

from labcal.calibrate.validity.change import ChangeKind
from labcal.calibrate.validity.explanation import Explanation
from labcal.cameras.rig import Rig
from labcal.cameras.rig_covariance import RigCovariance
from labcal.errors import InputError
from labcal.guide.rig_check import FEWEST_VIEWS, LIKELY, CheckVerdict, RigCheck
from labcal.guide.volume_cost import Volume
from labcal.wording import counted, listed

MOST_SIGMA0 = 2.0
"""Times their expected size, above which residuals say that no change of poses and focus explains them."""
MOST_TIMES_BUDGET = 3.0
"""Times the budget before, which the mended rig's may reach."""
_POSE = {ChangeKind.TURNED, ChangeKind.SHIFTED, ChangeKind.MOVED}
_ALONE = (ChangeKind.TURNED, ChangeKind.SHIFTED)
"""Kinds that are corrected by themselves where more than a target between two cameras tells them."""
_CORRECTIONS: dict[ChangeKind, tuple[ChangeKind, ...]] = {
    ChangeKind.REFOCUSED: (ChangeKind.REFOCUSED,),
    ChangeKind.TURNED: (),
    ChangeKind.SHIFTED: (),
    ChangeKind.MOVED: (),
    ChangeKind.MOVED_AND_REFOCUSED: (ChangeKind.REFOCUSED, ChangeKind.MOVED_AND_REFOCUSED),
}
"""Kinds of corrections, and the changes of focus that each contains."""


def mended_rig(check: RigCheck) -> Rig:
    """Return the rig after the change that a check found.

    The relative pose is corrected, or the focal length of a camera, or both with its principal point. Where
    it cannot be determined what changed, poses and focal lengths of all cameras are.

    Parameters
    ----------
    check : RigCheck

    Raises
    ------
    InputError
        Nothing has changed, views are too few or not explained, or the rig would be too uncertain.
    """
    if check.verdict is not CheckVerdict.CHANGED:
        raise InputError(
            f"The verdict on this rig is '{check.verdict.value}': there is no change to correct. Use it as "
            "it is, or take more pictures to be surer."
        )
    if check.changes[0].kind is ChangeKind.TOGETHER and check.changes[0].probability >= LIKELY:
        raise InputError(
            "All cameras moved together: relative to each other they are as calibrated, and nothing is to be "
            "corrected. Use the rig as it is, and measure the places of the marks anew."
        )
    if len(check.views) < FEWEST_VIEWS and not check.tested.made.marks:
        raise InputError(
            f"{counted(len(check.views), 'view')} cannot correct a rig. Take {FEWEST_VIEWS} or more, with "
            "different tilts, all over the volume."
        )
    unseen = set(check.rig.cameras) - set(check.by_camera)
    if unseen:
        raise InputError(
            f"There are no pictures of {listed(sorted(unseen))}: a correction needs all cameras of the rig. "
            "Take views with all of them."
        )
    if check.sigma0 > MOST_SIGMA0:
        raise InputError(
            f"No change of poses and focus explains these pictures: residuals stay {check.sigma0:.2g} times "
            "as large as they should be. Calibrate anew."
        )
    found = _correction(check)
    rig = _corrected(check, found)
    state, noise = found.evidence.state, np.median(check.tested.made.views.observations.covariance, axis=0)
    volume = Volume.of(rig, state, noise)
    if volume is not None and check.budget_mm is not None:
        budget = volume.budget_mm()
        if not budget <= MOST_TIMES_BUDGET * check.budget_mm:
            raise InputError(
                f"The corrected rig would place points with a sigma of {budget:.2g} mm, where it was "
                f"{check.budget_mm:.2g} mm: these pictures do not support a correction. Take more views, "
                "with different tilts and distances, or calibrate anew."
            )
    return rig.model_copy(
        update={"calibrated_on": tuple(dict.fromkeys((*check.rig.calibrated_on, *check.views)))}
    )


def _correction(check: RigCheck) -> Explanation:
    """Return the explanation with the fewest parameters that contains all that are likely.

    Within a pair that sees a target in the hand, a turn, a shift and a motion of either camera are motions of
    one beside the other.
    """
    test = check.tested
    pair = len(test.made.cameras) == 2 and not test.made.marks  # noqa: PLR2004 -- as said
    shares = test.probabilities
    best, reached, fewest = test.changed[-1], 1.0, np.inf
    for one in test.changed[:-1]:
        if one.change is None or one.change.kind not in _CORRECTIONS:
            continue
        contained = 0.0
        for other, share in zip(test.changed, shares.tolist(), strict=True):
            if other.change is None or other.change.kind is ChangeKind.SEVERAL:
                continue
            same = other.change.cameras == one.change.cameras
            by_pose = other.change.kind in _POSE and (pair or same)
            by_pose = by_pose and one.change.kind is not ChangeKind.REFOCUSED
            if one.change.kind in _ALONE:
                by_pose = not pair and same and other.change.kind is one.change.kind
            by_focus = same and other.change.kind in _CORRECTIONS[one.change.kind]
            contained += share if by_pose or by_focus else 0.0
        better = (one.change.count, -contained) < (fewest, -reached)
        if contained >= LIKELY and better:
            best, reached, fewest = one, contained, one.change.count
    return best


def _corrected(check: RigCheck, found: Explanation) -> Rig:
    """Return the cameras of an explanation as a rig, with the covariance that calibration and views leave."""
    old, views, state = check.rig, check.tested.made.views, found.evidence.state
    rig = Rig.of(dict(zip(old.cameras, views.rig_cameras(state), strict=True)))
    to_rig = views.rig_columns(state)
    matrix = to_rig @ found.covariance @ to_rig.T
    matrix = 0.5 * (matrix + matrix.T)
    known = old.covariance
    record = RigCovariance.of(rig.cameras, matrix)
    if known is not None:
        record = record.model_copy(
            update={
                "noise_factor": known.noise_factor,
                "view_factor": known.view_factor,
                "print_sigma_mm": known.print_sigma_mm,
            }
        )
    kept = {"calibration": old.calibration, "target": old.target}
    return rig.model_copy(update={"covariance": record, **kept})
