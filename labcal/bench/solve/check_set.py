"""One simulated calibration, checked by new views of the rig as it was, and after changes of known size."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np
from pydantic import BaseModel, ConfigDict

from labcal.bench.solve.budget_rigs import KINDS, PairKind
from labcal.bench.solve.pair_dots import CAMERAS, pair_dots
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.validity.change import Change, ChangeKind
from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.guide.checking import checked
from labcal.guide.rig_check import CheckVerdict, RigCheck
from labcal.guide.volume_cost import Volume
from labcal.report.values import Measured
from labcal.rng import generator
from labcal.targets.grid import DotGrid

NOISE_PX = 0.05
PRINTS = ("even", "uneven")
NEW_VIEWS = 3
UNCHANGED = 2
"""Checks of each rig as it was."""
SIZES = {
    ChangeKind.TURNED: (np.radians(0.01), np.radians(0.5)),
    ChangeKind.SHIFTED: (0.05, 2.0),
    ChangeKind.REFOCUSED: (0.001, 0.02),
}
"""Least and largest; rad, mm and relative focal lengths."""


@dataclass(frozen=True)
class CheckSet:
    """A case: kind of pair, print, number of views of the calibration."""

    kind: str
    surface: str
    views: int
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"{self.kind}-{self.surface}-{self.views}-{self.seed}"


class ChangedFigures(BaseModel):
    """The check of one changed rig."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    kind: str
    found: bool
    cost_sigmas: Measured
    """RMS error of points by the true change, over their standard deviation."""
    named: bool | None
    """True if the camera that is named is the right one; null if the check names none."""
    mended_sigmas: Measured
    """RMS error of points after the correction, over the standard deviation before; NaN if it is refused."""


class CheckFigures(BaseModel):
    """All checks of one calibration."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    unchanged: int
    """Checks of the rig as it was."""
    alarms: int
    """Of the checks of the rig as it was, those that call it changed."""
    changed: tuple[ChangedFigures, ...]


def measured_checks(case: CheckSet) -> CheckFigures:
    """Simulate and calibrate, then check the rig unchanged and after one change of each kind."""
    kind = KINDS[case.kind]
    random = generator(case.seed, "bench solve", "check", case.kind, case.surface, str(case.views))
    target = simulated_target(kind)
    dots = target.points()
    if case.surface != PRINTS[0]:
        dots[:, :2] += kind.print_mm * random.standard_normal((len(dots), 2))
    true = RigState(kind.cameras(), np.zeros((0, 4, 4)), dots)
    noise = (NOISE_PX, random)
    views = pair_dots(true.cameras, target, dots, kind.poses(case.views, random), noise)
    rig = calibrate_handheld(views, target, "brown5", HandheldSettings(eccentricity_rounds=0)).rig

    def check(change: Change | None, size: np.ndarray) -> RigCheck:
        held = replace(true, T_world_target=np.array(kind.poses(NEW_VIEWS, random)))
        held = held if change is None else change.applied(held, size)
        dots_seen = pair_dots(held.cameras, target, dots, list(held.T_world_target), noise)
        return checked(rig, dots_seen, target)

    still = [check(None, np.zeros(0)) for _ in range(UNCHANGED)]
    alarms = sum(one.verdict is CheckVerdict.CHANGED for one in still)
    changed = [
        changed_figures(check(change, size), change, size, true) for change, size in random_changes(random)
    ]
    return CheckFigures(unchanged=UNCHANGED, alarms=alarms, changed=tuple(changed))


def random_changes(random: np.random.Generator) -> Iterator[tuple[Change, np.ndarray]]:
    """Yield a change of each kind, of either camera, in any direction and of any size between the limits."""
    for kind, (least, most) in SIZES.items():
        camera = int(random.integers(2))
        change = Change(kind, (camera,), (camera,))
        direction = random.standard_normal(change.count)
        direction /= np.linalg.norm(direction)
        yield change, np.exp(random.uniform(np.log(least), np.log(most))) * direction


def simulated_target(kind: PairKind) -> DotGrid:
    """Return the target with dots so small that their images have no eccentricity."""
    pitch = kind.board_mm / 12.0
    return DotGrid(
        name="held", cols=13, rows=10, pitch_x_mm=pitch, pitch_y_mm=pitch, dot_diameter_mm=0.01 * pitch,
        rings=None, margin_mm=0.5 * pitch,
    )  # fmt: skip


def changed_figures(found: RigCheck, change: Change, size: np.ndarray, true: RigState) -> ChangedFigures:
    """Return the figures of a check after a true change.

    Parameters
    ----------
    found : RigCheck
    change : Change
    size : ndarray, shape (count,)
        Of the change.
    true : RigState
        The true cameras before it.
    """
    start, noise = found.tested.made.calibrated.state, NOISE_PX**2 * np.eye(2)
    volume = Volume.of(found.rig, start, noise)
    start = replace(start, cameras=found.tested.made.views.rig_cameras(start))
    cost, after = float("nan"), float("nan")
    if volume is not None and found.budget_mm is not None:
        cost = _rms(volume.errors_mm(change.applied(start, size).cameras)) / found.budget_mm
        if found.verdict is CheckVerdict.CHANGED:
            with suppress(InputError):  # these pictures do not support a correction
                after = _after(found.mended(), change.applied(true, size), volume) / found.budget_mm
    right = None if found.camera is None else found.camera == CAMERAS[change.cameras[0]]
    return ChangedFigures(
        kind=change.kind.value,
        found=found.verdict is CheckVerdict.CHANGED,
        cost_sigmas=cost,
        named=right,
        mended_sigmas=after,
    )


def _after(mended: Rig, true: RigState, volume: Volume) -> float:
    """Return the RMS error of points of a corrected rig, from pixels of the true cameras, mm."""
    return _rms(replace(volume, rig=mended).errors_mm(true.cameras))


def _rms(errors: np.ndarray) -> float:
    return float(np.sqrt(np.nanmean((errors**2).sum(axis=1))))
