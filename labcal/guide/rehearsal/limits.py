"""The limits of a planned rig: what its errors come from, and what halving each would bring."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from enum import StrEnum

import numpy as np

from labcal.arrays import Pose
from labcal.errors import InputError
from labcal.guide.rehearsal.forecast import Forecast, forecast
from labcal.guide.rehearsal.laboratory import places
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.guide.rehearsal.rig_plan import ListedGeometry, PairGeometry, RigPlan
from labcal.guide.rehearsal.sources import Sources


class LimitName(StrEnum):
    """Name of a limit of a rig."""

    PIXELS = "pixels"
    BASELINE = "baseline"
    LENS = "lens"
    VIEWS = "views"
    PRINT = "print"


CHANGES = {
    LimitName.PIXELS: "noise of all pixels halved",
    LimitName.BASELINE: "baseline doubled, looking at the same volume",
    LimitName.LENS: "uncertainty of the lenses halved",
    LimitName.VIEWS: "twice as many views",
    LimitName.PRINT: "errors of the print halved",
}
"""The change that halves each limit, in words."""


@dataclass(frozen=True)
class Limit:
    """A limit, and the errors once it is halved.

    Attributes
    ----------
    name : LimitName
    change : str
        What is changed, in words.
    before_mm, after_mm : float
        RMS 3-D errors over the points that are seen both before and after; NaN where the changed rig cannot
        be calibrated.
    why_not : str
        Why there is no figure; empty where there is one.
    """

    name: LimitName
    change: str
    before_mm: float
    after_mm: float
    why_not: str = ""

    @property
    def gain(self) -> float:
        """Share by which the error falls."""
        return 1.0 - self.after_mm / self.before_mm


def limits_of(
    planned: PlannedRig,
    views: list[Pose],
    further: list[Pose],
    sources: Sources,
    now: Forecast,
    seed: int,
) -> tuple[Limit, ...]:
    """Return all limits, the one with the largest gain first.

    Each forecast is made anew with the one change; changes together bring more, or less, than their sum.

    Parameters
    ----------
    planned : PlannedRig
    views, further : list of ndarray, shape (4, 4)
        Planned poses, and those to take then.
    sources : Sources
    now : Forecast
        As planned.
    seed : int
        Of the poses before cameras that are farther apart.
    """
    halved = replace(sources, dots=sources.dots.times(0.5), points=sources.points.times(0.5))

    def apart() -> Forecast:
        wider = PlannedRig.of(farther_apart(planned.plan))
        return forecast(wider, wider.views(len(views), seed), sources)

    changed: dict[LimitName, Callable[[], Forecast]] = {
        LimitName.PIXELS: lambda: forecast(planned, views, halved),
        LimitName.BASELINE: apart,
        LimitName.LENS: lambda: forecast(planned, views, replace(sources, lens_share=0.5)),
        LimitName.VIEWS: lambda: forecast(planned, [*views, *further[: len(views)]], sources),
        LimitName.PRINT: lambda: forecast(
            planned, views, replace(sources, print_sigma_mm=0.5 * sources.print_sigma_mm)
        ),
    }
    found = [_limit(name, now, change) for name, change in changed.items()]
    return tuple(sorted(found, key=lambda limit: -np.nan_to_num(limit.gain, nan=-1.0)))


def farther_apart(plan: RigPlan) -> RigPlan:
    """Return a plan with all cameras twice as far from their middle."""
    geometry = plan.geometry
    if isinstance(geometry, PairGeometry):
        wider: PairGeometry | ListedGeometry = geometry.model_copy(
            update={"baseline_mm": 2.0 * geometry.baseline_mm}
        )
        return plan.model_copy(update={"geometry": wider})
    standing = places(plan)
    middle = np.mean([place.eye_mm for place in standing.values()], axis=0)
    moved = {
        name: place.model_copy(update={"eye_mm": tuple((2.0 * np.array(place.eye_mm) - middle).tolist())})
        for name, place in standing.items()
    }
    return plan.model_copy(update={"geometry": ListedGeometry(kind="places", places=moved)})


def _limit(name: LimitName, now: Forecast, changed: Callable[[], Forecast]) -> Limit:
    try:
        then = changed()
    except InputError as error:
        return Limit(name, CHANGES[name], now.rms_mm, float("nan"), str(error))
    common = now.seen & then.seen
    return Limit(name, CHANGES[name], now.rms_of(common), then.rms_of(common))
