"""One simulated calibration, checked by marks that stay where they are, measured before by the same rig."""

from dataclasses import dataclass

import numpy as np

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.check_set import (
    NOISE_PX,
    UNCHANGED,
    CheckFigures,
    changed_figures,
    random_changes,
    simulated_target,
)
from labcal.bench.solve.pair_dots import CAMERAS, pair_dots
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.validity.change import Change
from labcal.cameras.camera import Camera
from labcal.correspond.named_pixels import NamedPixels
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import PointFlag
from labcal.geometry.poses import transform
from labcal.guide.checking import checked_by_marks
from labcal.guide.rig_check import CheckVerdict, RigCheck
from labcal.reconstruct.named_points import reconstruct_named
from labcal.rng import generator

VIEWS, MARKS = 12, 20


@dataclass(frozen=True)
class MarkSet:
    """A case: kind of pair."""

    kind: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"marks-{self.kind}-{self.seed}"


def measured_mark_checks(case: MarkSet) -> CheckFigures:
    """Simulate, calibrate and measure marks, then check the rig unchanged and after a change of each kind."""
    kind = KINDS[case.kind]
    random = generator(case.seed, "bench solve", "check", "marks", case.kind)
    target = simulated_target(kind)
    true = RigState(kind.cameras(), np.eye(4)[None], kind.points(MARKS, random))
    views = kind.poses(VIEWS, random)
    dots = pair_dots(true.cameras, target, target.points(), views, (NOISE_PX, random))
    rig = calibrate_handheld(dots, target, "brown5", HandheldSettings(eccentricity_rounds=0)).rig
    places = reconstruct_named(rig, _pixels(true.cameras, true.dots, random)).points
    # The marks of a case are one draw of noise: where it looks like a misfit, they are places all the same.
    places = NamedPoints(
        places.view, places.name, places.point, places.covariance, np.full(len(places), PointFlag.OK.value)
    )

    def check(change: Change | None, size: np.ndarray) -> RigCheck:
        now = true if change is None else change.applied(true, size)
        pixels = _pixels(now.cameras, transform(now.T_world_target[0], true.dots), random)
        return checked_by_marks(rig, pixels, places)

    still = [check(None, np.zeros(0)) for _ in range(UNCHANGED)]
    return CheckFigures(
        unchanged=UNCHANGED,
        alarms=sum(one.verdict is CheckVerdict.CHANGED for one in still),
        changed=tuple(
            changed_figures(check(change, size), change, size, true)
            for change, size in random_changes(random)
        ),
    )


def _pixels(cameras: tuple[Camera, ...], p: np.ndarray, random: np.random.Generator) -> NamedPixels:
    """Return named pixels of points, with noise."""
    q = np.concatenate([camera.project(p).q for camera in cameras])
    names = [f"mark-{number:02d}" for number in range(len(p))]
    return NamedPixels(
        np.full(len(q), "now"),
        np.repeat(CAMERAS, len(p)),
        np.tile(names, len(cameras)),
        q + NOISE_PX * random.standard_normal(q.shape),
        np.tile(NOISE_PX**2 * np.eye(2), (len(q), 1, 1)),
    )
