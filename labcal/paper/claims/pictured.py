"""The data of arms from pictures: a rendered shoot for every seed, and the dots detected in it."""

from collections.abc import Iterable
from dataclasses import replace
from pathlib import Path

import numpy as np

from labcal.correspond.dot_source import dots_of_shoot
from labcal.paper.claims.arm_data import ArmProblem
from labcal.paper.claims.plan import ArmData, Claim
from labcal.paper.pictured import kept_shoot, pictured_problems
from labcal.paper.rows import SCENES, Data
from labcal.render.shoot import RenderSettings
from labcal.run.progress import Progress
from labcal.scene.catalogue import load_scene

_DATA = {ArmData.WEBCAM_PICTURES: Data.WEBCAM_PLANE, ArmData.STILL_PICTURES: Data.STILL_PLANE}
Pictured = dict[tuple[ArmData, int], ArmProblem]
"""Data from pictures by their kind and seed."""


def needed_shoots(claims: Iterable[Claim], most_seeds: int | None) -> list[tuple[ArmData, int]]:
    """Return which shoots claims need: the kind of data, and the seed.

    Parameters
    ----------
    claims : iterable of Claim
    most_seeds : int, optional
        Fewer pairs than the plan asks for.
    """
    needed: dict[tuple[ArmData, int], None] = {}
    for claim in claims:
        for comparison in claim.comparisons:
            count = claim.pairs(comparison, most_seeds)
            for name in claim.compared_arms(comparison):
                if (data := claim.arms[name].data) in _DATA:
                    needed |= {(data, seed): None for seed in range(count)}
    return list(needed)


def pictured_data(
    needed: Iterable[tuple[ArmData, int]], folder: Path, settings: RenderSettings, progress: Progress
) -> Pictured:
    """Render what is missing, detect the dots, and return the data of arms.

    Parameters
    ----------
    needed : iterable
        See :func:`needed_shoots`. The seed is that of the rendering.
    folder : Path
        Where the shoots are kept; those of an interrupted run are used.
    settings : RenderSettings
        Rays a pixel and workers.
    progress : Progress

    Raises
    ------
    OutputError, DeviceError
        As of :func:`labcal.render.shoot.render_shoot`.
    """
    problems: Pictured = {}
    for data, seed in needed:
        scene = SCENES[_DATA[data]]
        shoot = kept_shoot(folder / f"{data}-{seed}", scene, replace(settings, seed=seed), progress)
        found = pictured_problems(_DATA[data], shoot, dots_of_shoot(shoot, settings.workers, progress))
        cameras = tuple(camera.camera() for camera in load_scene(scene).cameras.values())
        problems[data, seed] = ArmProblem(found[""], cameras, np.zeros(2 * len(cameras)))
    return problems
