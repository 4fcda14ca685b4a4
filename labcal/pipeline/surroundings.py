"""Cameras and target around evaluated points: those of the truth, or of what reconstructed them."""

import os
from collections.abc import Collection
from typing import TYPE_CHECKING

import numpy as np

from labcal.cameras.rig import Rig
from labcal.correspond.boards_table import in_one_frame
from labcal.correspond.detections import Detections
from labcal.errors import InputError
from labcal.estimators.model import Model
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.own_lengths import LengthErrors
from labcal.evaluate.reprojection import Reprojected, reprojected
from labcal.paths import AnyPath
from labcal.pipeline.given import dots_of
from labcal.reconstruct.reconstruction import load_reconstructor
from labcal.report.evaluation_page import Surroundings
from labcal.shoot.dataset import Shoot
from labcal.shoot.truth import read_truth

if TYPE_CHECKING:
    from labcal.targets.catalogue import AnyTarget
    from labcal.targets.places import DotPlaces


def surroundings(
    errors: TruthErrors | LengthErrors,
    shown: "Shoot | AnyTarget | DotPlaces",
    rig: Rig | Model | Collection[str] | AnyPath | None,
    detections: Detections | AnyPath | None,
) -> Surroundings:
    """Return cameras and places of the target in the world in which errors are drawn.

    Parameters
    ----------
    errors : TruthErrors or LengthErrors
        Against a truth, its world is meant; else that of the points.
    shown : Shoot, AnyTarget or DotPlaces
    rig : Rig, Model, path, names of views or None
        What the points were reconstructed with, where it is known.
    detections : Detections, path or None
        What they come from, where it is known.
    """
    used = _loaded(rig)
    if isinstance(errors, TruthErrors) and isinstance(shown, Shoot):
        truth = read_truth(shown.folder)
        cameras = {name: record.camera() for name, record in truth.cameras.items()}
        poses = {name: np.array(view.T_world_target) for name, view in truth.views.items()}
        residuals: list[Reprojected] = []
        if isinstance(used, Rig) and detections is not None:
            dots = in_one_frame(dots_of(detections, None), shown.target)
            residuals = reprojected(used, errors.points, dots, shown.target)
        return Surroundings(cameras, poses, residuals)
    if isinstance(used, Rig):
        return Surroundings({name: used.camera(name) for name in used.cameras}, {})
    if isinstance(used, Model) and used.resected is not None:
        return Surroundings(dict(zip(used.cameras, used.resected, strict=True)), {})
    return Surroundings({}, {})


def _loaded(rig: Rig | Model | Collection[str] | AnyPath | None) -> Rig | Model | None:
    """Return what points were reconstructed with; None where only its views are known, or it needs more."""
    if isinstance(rig, Rig | Model):
        return rig
    if not isinstance(rig, str | os.PathLike):
        return None
    try:
        return load_reconstructor(rig)
    except InputError:  # a model of a method of one's own, which is not named here
        return None
