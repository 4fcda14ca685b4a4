"""What ``labcal fit`` learns from: views on a stage, or of a target that was held in the hand."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.session import Session

if TYPE_CHECKING:
    from labcal.cli.inconsistent_result import InconsistentResult
    from labcal.correspond.detections import Detections
    from labcal.shoot.dataset import Shoot
    from labcal.solve.centred_training import CentredTraining
    from labcal.targets.catalogue import AnyTarget


@dataclass(frozen=True)
class HandheldResult:
    """How a bundle adjustment placed a target that was held."""

    lens: str
    views: int
    """That entered."""
    left_out: tuple[str, ...]
    """Pictures that did not, each with its reason, for people."""
    rms_px: float
    outlier_count: int
    free_dots: bool
    """Whether the places of the dots on the print were estimated."""
    inconsistent: "InconsistentResult | None"
    """Why the cameras do not agree on where the target was; null where they do."""

    def words(self) -> str:
        """Return it for people."""
        freed = "with" if self.free_dots else "without"
        return (
            f"the target was held: a bundle adjustment of {self.views} views ({len(self.left_out)} pictures "
            f"left out), lens {self.lens}, {freed} free dots, left an RMS of {self.rms_px:.4f} px and "
            f"{self.outlier_count} outliers; the first camera is the world"
        )


def read_training(arguments: Namespace, session: Session) -> "tuple[CentredTraining, HandheldResult | None]":
    """Return the training data of the source that is named, and how its target was placed without a stage.

    Raises
    ------
    InputError
        As of :func:`~labcal.workflow.training_data`, of :func:`~labcal.workflow.calibrate`, or an option
        does not go with the source.
    """
    import numpy as np

    from labcal.cli.inputs import choose_target, read_or_detect, require_shoot_or_table
    from labcal.correspond.detections import read_detections
    from labcal.errors import InputError
    from labcal.shoot.dataset import is_shoot, open_shoot
    from labcal.shoot.manifest import Role
    from labcal.workflow import centred_training, training_data

    require_shoot_or_table(arguments.source)
    shoot = open_shoot(Path(arguments.source)) if is_shoot(Path(arguments.source)) else None
    if shoot is None and arguments.detections is not None:
        raise InputError("--detections goes with the folder of a shoot. Give the table alone.")
    on_stage = shoot is not None and _on_stage(shoot)
    if on_stage and (arguments.free_dots or arguments.target is not None):
        raise InputError(
            "--free-dots and --target are for a target that was held, but a stage tells where that of this "
            "shoot was. Leave them out."
        )
    target = choose_target(arguments.target, [arguments.source])
    detections = (
        read_detections(arguments.detections)
        if arguments.detections is not None
        else read_or_detect(arguments.source, target, arguments.workers, session)
    )
    if shoot is None:
        return _held(arguments, detections, target, session)
    if on_stage:
        data = training_data(shoot, detections)
        return centred_training(data, shoot.target, shoot.nominal_poses()), None
    trained = [view.name for view in shoot.views(Role.TRAIN)]
    return _held(arguments, detections.where(np.isin(detections.view, trained)), target, session)


def _on_stage(shoot: "Shoot") -> bool:
    """Tell whether a stage says where the target was in training views."""
    from labcal.shoot.manifest import Role

    poses = shoot.nominal_poses()
    return any(view.name in poses for view in shoot.views(Role.TRAIN))


def _held(
    arguments: Namespace, detections: "Detections", target: "AnyTarget", session: Session
) -> "tuple[CentredTraining, HandheldResult]":
    """Return the training data of a target that was held."""
    from labcal.cli.calibrate import calibrated
    from labcal.cli.inconsistent_result import inconsistent_result
    from labcal.solve.handheld import HandheldSettings
    from labcal.workflow import handheld_training

    settings = HandheldSettings(free_dots=arguments.free_dots)
    found, choice = calibrated(detections, target, arguments.lens, settings, session)
    how = HandheldResult(
        lens=choice.lens if choice else arguments.lens,
        views=len(found.views),
        left_out=found.skipped,
        rms_px=found.rms_px,
        outlier_count=len(found.outliers),
        free_dots=arguments.free_dots,
        inconsistent=inconsistent_result(found),
    )
    return handheld_training(found, detections, target), how
