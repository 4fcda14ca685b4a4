"""Training data of methods: dots of a target on a stage, or in the hand (placed by a bundle adjustment)."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from labcal.arguments import (
    object_of,
    settings_of,
)
from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.calibration import Calibration
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.correspond.training import TrainingData, training_data
from labcal.errors import InputError
from labcal.estimators.centred_training import CentredTraining, centred_training
from labcal.estimators.fit_settings import FitSettings
from labcal.estimators.gp_field.stage_moves import StageMoves
from labcal.estimators.handheld_training import handheld_training
from labcal.estimators.stage_errors import StageSigma, stage_errors
from labcal.public_object import PublicObject
from labcal.run.progress import Progress
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.targets.catalogue import AnyTarget, target_of


@dataclass(frozen=True, eq=False, repr=False)
class Training(PublicObject):
    """Training data, and how they were made.

    Attributes
    ----------
    centred : CentredTraining
        Pixels and points.
    held : Calibration or None
        The calibration that placed the target; None on a stage.
    warnings : tuple of str
        Warnings in words.
    held_out : tuple of str
        Test views.
    """

    centred: CentredTraining
    held: Calibration | None
    warnings: tuple[str, ...]
    held_out: tuple[str, ...] = ()

    def _summary(self) -> Mapping[str, object]:
        return {
            "cameras": list(self.centred.data.cameras),
            "views": len(self.calibrated_on),
            "points": len(self.centred.data.X),
            "warnings": len(self.warnings),
        }

    @property
    def calibrated_on(self) -> tuple[str, ...]:
        """Names of the training views."""
        if self.held is not None:
            return self.held.calibrated_on
        return tuple(dict.fromkeys(self.centred.data.view.tolist()))


def on_stage(shoot: Shoot) -> bool:
    """Tell whether a stage says where the target was in training views."""
    poses = shoot.nominal_poses()
    return any(view.name in poses for view in shoot.views(Role.TRAIN))


def training_of(
    source: Shoot | AnyTarget,
    detections: Detections,
    settings: FitSettings | None = None,
    progress: Progress | None = None,
) -> Training:
    """Return training data, without causes of warnings, as of :func:`labcal.pipeline.training_of`."""
    settings = settings_of(settings, FitSettings)
    if not isinstance(source, Shoot):
        source = target_of(source)
    detections = object_of(detections, Detections, "detections")
    tested = tuple(view.name for view in source.views(Role.TEST)) if isinstance(source, Shoot) else ()
    if isinstance(source, Shoot) and on_stage(source):
        _refuse_of_held(settings)
        data = training_data(source, on_target(detections, source.target))
        centred = centred_training(data, source.target, source.nominal_poses())
        if settings.stage_sigma is not None:
            centred = _with_stage_errors(centred, source, settings.stage_sigma)
        return Training(centred, None, _unused_views(source, data), tested)
    if isinstance(source, Shoot):
        trained = [view.name for view in source.views(Role.TRAIN)]
        detections = detections.where(np.isin(detections.view, trained))
    if settings.stage_sigma is not None:
        raise InputError(
            "`stage_sigma_mm` and `stage_sigma_deg` are for a target on a stage, but this one was held in "
            "the hand. Leave them out."
        )
    target = source.target if isinstance(source, Shoot) else source
    how = HandheldSettings(dot_places=settings.dot_places)
    detections = on_target(detections, target)
    found = calibrated(detections, target, settings.lens, how, settings.hold_out, progress)
    dots = handheld_training(found.found, detections, found.found.boards or target)
    return Training(dots, found, found.warnings, (*found.held_out, *tested))


def _with_stage_errors(centred: CentredTraining, shoot: Shoot, sigma: StageSigma) -> CentredTraining:
    """Return training data with what errors of the stage do to their cameras."""
    if centred.cameras is None:
        raise InputError(
            "`stage_sigma_mm` and `stage_sigma_deg` are propagated by the cameras that the training dots "
            f"determine, but there are none: {centred.reason}. Leave them out; no covariance then holds the "
            "errors of the stage."
        )
    data, poses = centred.data, shoot.nominal_poses()
    errors = stage_errors(centred.cameras, data, poses, sigma)
    moves = StageMoves.of(data.view, data.Y, poses, sigma.mm, sigma.deg)
    return replace(centred, stage=errors, moves=moves)


def _refuse_of_held(settings: FitSettings) -> None:
    """Raise where settings are given that would be dropped, since a stage gives the poses of the target."""
    usual = {"dot_places": DotTreatment.AUTO, "hold_out": ()}
    for name, value in usual.items():
        given = getattr(settings, name)
        if given != value:
            named = f"{name}='{given}'" if isinstance(given, DotTreatment) else name
            raise InputError(
                f"`{named}` is for a hand-held target, but this shoot's target stood on a stage. Leave it "
                "out."
            )


def _unused_views(shoot: Shoot, data: TrainingData) -> tuple[str, ...]:
    """Return warnings about training views without usable dots."""
    used = set(data.view.tolist())
    views = [view.name for view in shoot.views(Role.TRAIN) if view.name not in used]
    return tuple(f"view '{name}' is not used: no dot in it was measured by all cameras" for name in views)
