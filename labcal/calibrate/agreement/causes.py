"""Causes of inconsistent pictures, the most likely first."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from jaxtyping import Int64

from labcal.calibrate.agreeing_views import CalibrateSingle
from labcal.calibrate.agreement.exchange.by_poses import exchanged_views, with_exchanged
from labcal.calibrate.agreement.exchange.decision import LEFT, exchange_cause
from labcal.calibrate.agreement.finding import Cause, CauseName, Disagreement
from labcal.calibrate.agreement.hypotheses import (
    EXPLAINED,
    SMOOTH,
    disagrees,
    explained,
    moves,
    surely,
    telling_views,
    times,
    together,
)
from labcal.calibrate.agreement.pair import PairAgreement
from labcal.calibrate.rig_start import SharedViews
from labcal.calibrate.single_calibration import MIN_VIEWS, SingleCalibration
from labcal.correspond.detections import Detections
from labcal.errors import InputError

_MOST = 0.8
"""Share of what errors do not explain from which on an explanation is the likeliest."""


@dataclass(frozen=True)
class Calibrated:
    """Single-camera calibrations, and a way to repeat them."""

    cameras: Sequence[SingleCalibration]
    entering: Detections
    again: CalibrateSingle
    free_dots: bool = False
    """True if dots were freed with these cameras."""

    def pairs(self) -> list[PairAgreement]:
        """Return the agreement of every two cameras with shared views."""
        pairs = (PairAgreement.of(one, other) for one, other in combinations(self.cameras, 2))
        return [pair for pair in pairs if pair is not None]

    def camera(self, name: str) -> SingleCalibration:
        """Return one camera."""
        return next(camera for camera in self.cameras if camera.name == name)

    def words(self, pair: PairAgreement, places: Sequence[int]) -> tuple[str, ...]:
        """Return the names of some of the views that two cameras share, in their order."""
        return tuple(self.entering.views[pair.poses.views[place]] for place in sorted(places))


def disagreement(found: Calibrated) -> Disagreement | None:
    """Return the likely causes if cameras disagree, or None if they agree."""
    if any(camera.single.camera.model.parallel for camera in found.cameras):
        return None  # parallel rays alone tell neither depth nor the sign of a tilt
    pairs = found.pairs()
    apart = [pair for pair in pairs if disagrees(pair, len(pairs), freed=found.free_dots)]
    if not apart:
        return None
    worst = max(apart, key=times)
    causes = _causes(found, worst, [{pair.first, pair.second} for pair in apart])
    return Disagreement(causes, times(worst))


def _causes(found: Calibrated, pair: PairAgreement, apart: list[set[str]]) -> tuple[Cause, ...]:
    """Return the possible causes for one pair; `apart` are all pairs that disagree."""
    exchanged = _exchanged(found, pair)
    if exchanged is not None:
        return (exchanged,)
    groups = moves(pair)
    agrees, share = pair.chance(groups) >= EXPLAINED, explained(pair, groups)
    may_be_moved = agrees or share > _MOST
    in_order = may_be_moved and surely(pair, groups)
    telling = found.words(pair, telling_views(pair))
    causes = [_target_moved(pair, telling, in_no_order=not may_be_moved)]
    if may_be_moved:
        rest = "all views agree" if agrees else f"{share:.0%} of the contradiction is explained"
        moved = _camera_moved(found, pair, groups, apart, rest)
        causes.insert(0 if in_order else 1, moved)
    if pair.smooth.inflation > SMOOTH:
        causes.append(_lens_misfit(found, pair, telling))
    return tuple(causes)


def _camera_moved(
    found: Calibrated,
    pair: PairAgreement,
    groups: Int64[np.ndarray, " n"],
    apart: list[set[str]],
    rest: str,
) -> Cause:
    """Return the cause that a camera was moved between views; `rest` says what that explains."""
    names = (pair.first, pair.second)
    moved = [name for name in names if all(name in cameras for cameras in apart)] or list(names)
    who = " or ".join(f"'{name}'" for name in moved)
    after = found.words(pair, np.flatnonzero(groups > 0).tolist())
    starts = found.words(pair, np.flatnonzero(np.diff(groups, prepend=groups[0])).tolist())
    from_views = ", ".join(f"'{view}'" for view in starts)
    last = int((groups == groups.max()).sum())
    if last >= MIN_VIEWS:
        advice = f"Fasten the cameras, and calibrate from the {last} views after it, or from new ones."
    else:
        advice = f"Fasten the cameras, and take new views: the {last} after it are too few."
    return Cause(
        CauseName.CAMERA_MOVED,
        f"camera {who} was moved, turned or refocused before view {from_views}: with another place from "
        f"there on {rest}. {advice}",
        tuple(moved),
        after,
    )


def _target_moved(pair: PairAgreement, telling: tuple[str, ...], *, in_no_order: bool) -> Cause:
    """Return the cause that pictures of a view were not taken at once."""
    return Cause(
        CauseName.UNSYNCHRONISED,
        f"the target moved between the exposures of '{pair.first}' and '{pair.second}', or pictures of "
        "different moments have the name of one view: the place of one camera beside the other differs from "
        f"view to view{' in no order' if in_no_order else ''}. Hold the target still, or trigger the cameras "
        "together; and look whether the pictures of a view show the target in the same place.",
        (pair.first, pair.second),
        telling,
    )


def _lens_misfit(found: Calibrated, pair: PairAgreement, telling: tuple[str, ...]) -> Cause:
    """Return the cause that the calibration models do not fit the cameras."""
    advice = "Try `lens='auto'`." if found.free_dots else "Try `lens='auto'` or `dot_places='freed'`."
    return Cause(
        CauseName.LENS_MISFIT,
        f"the lens model or the flat board does not suit, which each camera alone shows, too. {advice}",
        (pair.first, pair.second),
        telling,
    )


def _exchanged(found: Calibrated, pair: PairAgreement) -> Cause | None:
    """Return the cause that pictures bear each other's camera's name, where exchanging them mends all."""
    first, second = found.camera(pair.first), found.camera(pair.second)
    shared = SharedViews.of(first.single, second.single)
    of_views = exchanged_views(first, second, first.result.adjusted.state.dots)
    if of_views is None or not of_views.any():
        return None
    views = tuple(found.entering.views[view] for view in shared.views[of_views])
    names = (pair.first, pair.second)
    mended = with_exchanged(found.entering, names, views)
    try:
        again = PairAgreement.of(*(found.again(name, mended) for name in names))
    except InputError:
        return None
    if again is None:
        return None
    left = again.misfit(together(again)) / max(pair.misfit(together(pair)), 1e-300)
    if again.chance(together(again)) < EXPLAINED and left > LEFT**2:
        return None
    where = f"{len(views)} of {len(of_views)} views, or in all others"
    return exchange_cause(names, views, where, f"{left:.2%} of the contradiction is left")
