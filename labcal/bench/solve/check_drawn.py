"""One calibration by drawn pictures, checked by drawn pictures of the rig as it was, and after changes.

Outlines of all dots are projected and filled, seen through a sensor with photon and read noise, and measured
by the detector: what a check gets of a camera, without the time that rays take.
"""

from dataclasses import dataclass, replace

import numpy as np

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.check_set import NEW_VIEWS, CheckFigures, changed_figures, random_changes
from labcal.bench.solve.pair_dots import CAMERAS
from labcal.calibrate.adjustment.state import RigState
from labcal.calibrate.handheld import HandheldSettings, calibrate_handheld
from labcal.calibrate.validity.change import Change
from labcal.correspond.detections import Detections
from labcal.correspond.gathering import gather
from labcal.correspond.sources import Source
from labcal.detect.detector import detect_dots
from labcal.guide.checking import checked
from labcal.guide.rehearsal.drawn_view import drawn_view
from labcal.guide.rig_check import CheckVerdict, RigCheck
from labcal.render.sensor_response import Shot
from labcal.rng import generator
from labcal.scene.photometry import Photometry
from labcal.targets.grid import DotGrid

VIEWS = 12
UNCHANGED = 4
"""Checks of each rig as it was."""
MOST_SHOTS = 20
ROUNDS = 2
"""Changes of each kind."""


@dataclass(frozen=True)
class DrawnSet:
    """A case: kind of pair."""

    kind: str
    seed: int

    @property
    def key(self) -> str:
        """The name of the result file."""
        return f"drawn-{self.kind}-{self.seed}"


def measured_drawn(case: DrawnSet) -> CheckFigures:
    """Draw and calibrate, then check the rig unchanged and after changes of each kind."""
    kind = KINDS[case.kind]
    random = generator(case.seed, "bench solve", "check", "drawn", case.kind)
    target = kind.target()
    true = RigState(kind.cameras(), np.zeros((0, 4, 4)), target.points())
    drawn = replace(true, T_world_target=np.array(kind.poses(VIEWS, random)))
    rig = calibrate_handheld(_dots(drawn, target, random), target, "brown5", HandheldSettings()).rig

    def check(change: Change | None, size: np.ndarray) -> RigCheck:
        for _ in range(MOST_SHOTS):  # until all pictures can be measured, as whoever takes them sees to
            held = replace(true, T_world_target=np.array(kind.poses(NEW_VIEWS, random)))
            held = held if change is None else change.applied(held, size)
            dots = _dots(held, target, random)
            if len(set(dots.image[dots.has_id & (dots.flag == "ok")].tolist())) == NEW_VIEWS * len(CAMERAS):
                break
        return checked(rig, dots, target)

    still = [check(None, np.zeros(0)) for _ in range(UNCHANGED)]
    changes = [one for _ in range(ROUNDS) for one in random_changes(random)]
    return CheckFigures(
        unchanged=UNCHANGED,
        alarms=sum(one.verdict is CheckVerdict.CHANGED for one in still),
        changed=tuple(changed_figures(check(change, size), change, size, true) for change, size in changes),
    )


def _dots(state: RigState, target: DotGrid, random: np.random.Generator) -> Detections:
    """Return the dots that the detector measures in drawn pictures."""
    seed, photometry = int(random.integers(2**31)), Photometry()
    sources, found = [], []
    for view, T in enumerate(state.T_world_target):
        for name, camera in zip(CAMERAS, state.cameras, strict=True):
            picture = drawn_view(camera, T, target, photometry, Shot(seed, f"view-{view:02d}", name))
            dots = detect_dots(picture.picture, target)
            moved = replace(
                dots, size=camera.size, position=dots.position + picture.corner,
                seen_at=dots.seen_at + picture.corner,
            )  # fmt: skip
            found.append(moved)
            name_of_picture = f"view-{view:02d}_{name}.png"
            sources.append(Source(f"view-{view:02d}", name, name_of_picture, camera.size))
    return gather(sources, found)
