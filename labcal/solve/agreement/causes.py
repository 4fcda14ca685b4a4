"""Why cameras do not agree on where the target was: what may have happened, the likeliest first."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.solve.agreement.exchange import exchanged_views, with_exchanged
from labcal.solve.agreement.finding import Cause, CauseName, Disagreement
from labcal.solve.agreement.hypotheses import (
    EXPLAINED,
    LEAST_TIMES,
    SMOOTH,
    disagrees,
    explained,
    moves,
    telling_views,
    times,
    together,
)
from labcal.solve.agreement.pair import PairAgreement
from labcal.solve.lone_calibration import CameraAlone
from labcal.solve.rig_start import SharedViews

CalibrateAlone = Callable[[str, Detections], CameraAlone]
"""Calibrates one camera, by its name, from all its pictures."""

_MOST = 0.8
"""Share of what errors do not explain from which on an explanation is the likeliest."""
_MENDED = 0.01
"""What is left of a misfit where exchanged pictures were its cause."""


@dataclass(frozen=True)
class Calibrated:
    """Cameras that were calibrated alone, and how they can be once more."""

    cameras: Sequence[CameraAlone]
    entering: Detections
    again: CalibrateAlone
    least_times: float = LEAST_TIMES
    """Times the variance that errors explain, from which on a contradiction is worth a word."""

    def pairs(self) -> list[PairAgreement]:
        """Return how every two cameras with shared views agree."""
        pairs = (PairAgreement.of(one, other) for one, other in combinations(self.cameras, 2))
        return [pair for pair in pairs if pair is not None]

    def camera(self, name: str) -> CameraAlone:
        """Return one camera."""
        return next(camera for camera in self.cameras if camera.name == name)

    def words(self, pair: PairAgreement, places: Sequence[int]) -> tuple[str, ...]:
        """Return the names of some of the views that two cameras share, in their order."""
        return tuple(self.entering.views[pair.poses.views[place]] for place in sorted(places))


def disagreement(found: Calibrated) -> Disagreement | None:
    """Return what is likely to have happened where cameras do not agree; None where they do."""
    pairs = found.pairs()
    apart = [pair for pair in pairs if disagrees(pair, len(pairs), found.least_times)]
    if not apart:
        return None
    worst = max(apart, key=times)
    causes = _causes(found, worst, [{pair.first, pair.second} for pair in apart])
    return Disagreement(causes, times(worst))


def _causes(found: Calibrated, pair: PairAgreement, apart: list[set[str]]) -> tuple[Cause, ...]:
    """Return the causes that may be, by one pair; `apart` are all pairs that do not agree."""
    names = (pair.first, pair.second)
    exchanged = _exchanged(found, pair)
    if exchanged is not None:
        return (exchanged,)
    groups = moves(pair)
    share = explained(pair, groups)
    agrees = pair.chance(groups) >= EXPLAINED
    moved = [name for name in names if all(name in cameras for cameras in apart)] or list(names)
    after = found.words(pair, [int(place) for place in np.flatnonzero(groups > 0)])
    starts = np.flatnonzero(np.diff(groups, prepend=groups[0])).tolist()
    from_views = ", ".join(f"'{view}'" for view in found.words(pair, starts))
    who = " or ".join(f"'{name}'" for name in moved)
    causes = []
    if agrees or share > _MOST:
        rest = "all views agree" if agrees else f"{share:.0%} of the contradiction is explained"
        causes.append(
            Cause(
                CauseName.CAMERA_MOVED,
                f"camera {who} was moved, turned or refocused before view {from_views}: with another place "
                f"from there on {rest}. Calibrate from the views after it, and fasten the cameras.",
                tuple(moved),
                after,
            )
        )
    telling = found.words(pair, telling_views(pair))
    apart_views = Cause(
        CauseName.UNSYNCHRONISED,
        f"the target moved between the exposures of '{names[0]}' and '{names[1]}': the place of one beside "
        f"the other differs from view to view{'' if share > _MOST else ' in no order'}. Hold the target "
        "still, or trigger the cameras together.",
        names,
        telling,
    )
    causes.insert(len(causes) if share > _MOST else 0, apart_views)
    if pair.smooth.inflation > SMOOTH:
        causes.append(
            Cause(
                CauseName.LENS_MISFIT,
                "the lens model or the flat board does not suit, which each camera alone shows, too. Try "
                "--lens auto or --free-dots.",
                names,
                telling,
            )
        )
    return tuple(causes)


def _exchanged(found: Calibrated, pair: PairAgreement) -> Cause | None:
    """Return the cause that pictures bear each other's camera's name, where exchanging them mends all."""
    first, second = found.camera(pair.first), found.camera(pair.second)
    shared = SharedViews.of(first.lone, second.lone)
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
    if again.chance(together(again)) < EXPLAINED and left > _MENDED:
        return None
    return Cause(
        CauseName.SWAPPED_CAMERAS,
        f"pictures of '{names[0]}' and '{names[1]}' are exchanged in {len(views)} of {len(of_views)} views, "
        f"or in all others: exchanged back, {left:.2%} of the contradiction is left. Say which picture is "
        "whose: labcal detect --cameras.",
        names,
        views,
    )
