"""What ``labcal fit`` learns from: views on a stage, or of a target that was held in the hand."""

from argparse import Namespace
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from labcal.cli.session import Session
from labcal.wording import counted

if TYPE_CHECKING:
    from labcal.cli.inconsistent_result import InconsistentResult
    from labcal.estimators.fitting import FitSettings, Training


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
        views, left_out = counted(self.views, "view"), counted(len(self.left_out), "picture")
        return (
            f"the target was held: a bundle adjustment of {views} ({left_out} left out), lens {self.lens}, "
            f"{freed} free dots, left an RMS of {self.rms_px:.4f} px and "
            f"{counted(self.outlier_count, 'outlier')}; the first camera is the world"
        )


def read_training(arguments: Namespace, session: Session) -> "Training":
    """Return what the source that is named teaches, and say what is not as it should be.

    Raises
    ------
    InputError
        As of :func:`~labcal.pipeline.training_of`, or an option does not go with the source.
    """
    from labcal.cli.inputs import choose_target, dots_of, refuse_idle_workers, say_roles, shoot_or_none
    from labcal.correspond.view_roles import parse_hold_out
    from labcal.errors import InputError
    from labcal.estimators.fitting import on_stage
    from labcal.pipeline import training_of

    refuse_idle_workers(arguments)
    shoot = shoot_or_none(arguments.source)
    held_only = (arguments.free_dots, arguments.target is not None, arguments.hold_out is not None)
    if shoot is not None and on_stage(shoot) and any(held_only):
        raise InputError(
            "--free-dots, --target and --hold-out are for a target that was held, but a stage tells where "
            "that of this shoot was. Leave them out."
        )
    target = choose_target(arguments.target, [arguments.source])
    detections = dots_of(arguments, target, session)
    source = shoot if shoot is None or shoot.target == target else shoot.showing(target)
    settings = fit_settings(arguments)
    if arguments.hold_out is not None:
        settings = replace(settings, hold_out=parse_hold_out(arguments.hold_out, detections.views))
    elif shoot is None:
        say_roles(detections, "fit", session)
    with session.progress() as progress:
        training = training_of(source or target, detections, settings, progress)
    for warning in training.warnings:
        session.warn(warning)
    return training


def fit_settings(arguments: Namespace) -> "FitSettings":
    """Return how methods are taught."""
    from labcal.estimators.fitting import FitSettings

    return FitSettings(arguments.lens, arguments.seed, arguments.free_dots, not arguments.no_rehearsal)


def handheld_result(training: "Training") -> HandheldResult | None:
    """Return how a target was placed that was held; None where a stage told."""
    held = training.held
    if held is None:
        return None
    from labcal.cli.inconsistent_result import inconsistent_result

    return HandheldResult(
        lens=held.lens,
        views=len(held.found.views),
        left_out=held.found.skipped,
        rms_px=held.found.rms_px,
        outlier_count=len(held.found.outliers),
        free_dots=held.found.freed is not None,
        inconsistent=inconsistent_result(held.found),
    )
