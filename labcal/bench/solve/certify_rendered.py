"""Decisions of the acceptance test on rendered volumes: rig and marks from pictures, lengths from the truth.

Dots of views that the calibration has not seen stand for two marks that are moved through the volume. Ends of
the planned lengths are the dots nearest to them, so that all lengths lie where the plan has them, nearly.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.arrays import Vectors3
from labcal.bench.groups import Bench, Findings
from labcal.bench.solve.certify_decision import (
    MOST_WRONG,
    Decided,
    clear_cases,
    decided_near_limit,
    is_wrong,
    share_undecided,
)
from labcal.calibrate.handheld import calibrate_handheld
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import triangulate
from labcal.correspond.dot_source import dots_of_shoot
from labcal.correspond.named_points import NamedPoints
from labcal.correspond.points import Points
from labcal.evaluate.acceptance.decision import Uncertainty
from labcal.evaluate.acceptance.length_plan import LengthPlan, plan_lengths
from labcal.geometry.poses import inverse, transform
from labcal.guide.rehearsal.catalogue import load_rig_plan
from labcal.guide.rehearsal.laboratory import laboratory
from labcal.guide.rehearsal.planned_rig import T_SCENE_PLAN
from labcal.guide.rehearsal.rig_plan import WorkingVolume
from labcal.reconstruct.reconstruction import reconstruct_points
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.report.bench import Check, Figure, at_most
from labcal.rng import generator
from labcal.run.machine import usable_cores
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.shoot.truth import read_true_dots

SETS = {"webcams": 3, "wide": 2}
"""Rendered sets of each plan."""
QUICK_SETS = {"webcams": 1}
LIMITS = 4
"""Limits of each set and kind of uncertainty; 40 cases in all."""
_TRAIN, _TEST, _SPP = 12, 8, 16
_SHORTEST = 0.5
"""Of a planned length, what there is of it at least."""


@dataclass(frozen=True)
class RenderedVolume:
    """A calibrated rig, and the dots of views that it has not seen.

    Attributes
    ----------
    rig : Rig
    measured : Points
        In the frame of the first camera.
    exact : float64 array, (n, 3)
        The same by the rig from the true pixels: with its own errors alone.
    true : float64 array, (n, 3)
        True places, mm, in the frame of the plan.
    """

    rig: Rig
    measured: Points
    exact: Vectors3
    true: Vectors3


def certify_rendered_findings(bench: Bench) -> Findings:
    """Return the share of wrong decisions on rendered volumes, and of clear cases that are left undecided."""
    decided: list[Decided] = []
    for name, sets in (QUICK_SETS if bench.quick else SETS).items():
        for seed in range(bench.seed, bench.seed + sets):
            decided += _decisions(name, seed, bench.folder / f"volume-{name}-{seed}", bench.progress)
    title = f"certify, {len(decided)} cases near the limit, rendered"
    wrong = float(np.mean([is_wrong(one) for one in decided]))
    checks: list[Check] = [
        at_most(f"{title}: share of wrong decisions", wrong, MOST_WRONG),
        at_most(
            f"{title}: share of clear cases undecided", share_undecided(clear_cases(decided)), MOST_WRONG
        ),
    ]
    return Findings(checks, [Figure(name=f"{title}: share undecided", value=share_undecided(decided))])


def _decisions(name: str, seed: int, folder: Path, progress: Progress) -> list[Decided]:
    """Render a set, calibrate, measure planned lengths, and decide about limits near the true errors."""
    volume = rendered_volume(name, seed, folder, progress)
    random = generator(seed, "bench solve", "certify rendered", name)
    plan, points = _planned(load_rig_plan(name).volume, volume)
    return [decided_near_limit(kind, plan, points, random) for kind in Uncertainty for _ in range(LIMITS)]


def rendered_volume(name: str, seed: int, folder: Path, progress: Progress) -> RenderedVolume:
    """Render views of a plan's target, calibrate from some and measure the dots of the others.

    Parameters
    ----------
    name : str
        Of a plan.
    seed : int
        Of poses, print and noise.
    folder : Path
        The shoot to appear.
    progress : Progress
    """
    plan = load_rig_plan(name)
    scene = laboratory(plan, _TRAIN)
    scene = scene.model_copy(update={"placement": scene.placement.model_copy(update={"test": _TEST})})
    rendering = RenderSettings(spp=_SPP, seed=seed, workers=usable_cores())
    shoot = render_shoot(scene, folder, rendering, progress)
    dots = dots_of_shoot(shoot, usable_cores(), progress)
    tested = np.isin(dots.view, [view.name for view in shoot.views(Role.TEST)])
    lens = next(iter(plan.cameras.values())).lens
    rig = calibrate_handheld(dots.where(~tested), plan.target, lens).rig
    measured = reconstruct_points(rig, dots.where(tested), plan.target)
    measured = measured.where(np.isfinite(measured.point).all(axis=1))
    q, true = _true(shoot, measured, rig, plan.target.cols)
    pixels = np.tile(np.eye(2), (len(q), len(rig.cameras), 1, 1))
    exact = triangulate([rig.camera(camera) for camera in rig.cameras], q, pixels).point
    return RenderedVolume(rig, measured, exact, transform(inverse(T_SCENE_PLAN), true))


def _true(shoot: Shoot, measured: Points, rig: Rig, cols: int) -> tuple[np.ndarray, Vectors3]:
    """Return the true pixels (n, cameras, 2) and places in the scene of measured dots."""
    true = {(one.view, one.camera): one for one in read_true_dots(shoot.folder)}
    number = (measured.index[:, 1] * cols + measured.index[:, 0]).tolist()
    lines = list(zip(measured.view.tolist(), number, strict=True))
    q = np.array([[true[view, name].centre[dot] for name in rig.cameras] for view, dot in lines])
    first = next(iter(rig.cameras))
    return q, np.array([true[view, first].point[dot] for view, dot in lines])


def _planned(volume: WorkingVolume, of: RenderedVolume) -> tuple[LengthPlan, tuple[NamedPoints, NamedPoints]]:
    """Return the plan with its ends at the nearest dots, and these ends: exact, and as measured."""
    sides = (volume.width_mm, volume.height_mm, volume.far_mm - volume.near_mm)
    middle = np.array([*volume.centre_mm, 0.5 * (volume.near_mm + volume.far_mm)])
    plan = plan_lengths(sides)
    a = np.linalg.norm((plan.end_a + middle)[:, None] - of.true, axis=2).argmin(axis=1)
    off = np.linalg.norm((plan.end_b + middle)[:, None] - of.true, axis=2)
    length = np.linalg.norm(of.true[a][:, None] - of.true, axis=2)
    off[length < _SHORTEST * plan.nominal_mm[:, None]] = np.inf  # dots lie apart: not the same one twice
    b = off.argmin(axis=1)
    measured = of.measured
    ends, n = np.concatenate([a, b]), len(a)
    views, names = np.tile(plan.lengths().view_a, 2), np.repeat(["a", "b"], n)
    exact, noisy = (
        NamedPoints(views, names, point[ends], measured.covariance[ends], np.full(2 * n, "ok"))
        for point in (of.exact, measured.point)
    )
    return LengthPlan(plan.volume_mm, of.true[a], of.true[b], ()), (exact, noisy)
