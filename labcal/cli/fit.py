"""``labcal fit``: methods fitted to views of a target."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.calibrate.lens_candidates import AUTO
from labcal.cli.dot_places import add_dot_places, dot_treatment
from labcal.cli.methods import named_estimators
from labcal.cli.options import (
    TogetherAction,
    add_detector_settings,
    add_hold_out,
    add_output,
    add_page,
    add_seed,
    add_workers,
    refuse_option,
)
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.run.decimal_words import decimal

if TYPE_CHECKING:
    from labcal.correspond.dot_source import DotSource
    from labcal.estimators.estimator import PointEstimator
    from labcal.estimators.training import Training
    from labcal.report.fit_result import FitOutcome
    from labcal.report.page.output import PageOutput
    from labcal.targets.catalogue import AnyTarget


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    from labcal.estimators.registry import method_entries

    parser = commands.add(
        "fit",
        run,
        "Fit methods to views of a target: on a stage that gives its poses, or held in the hand, where a "
        "bundle adjustment finds it. The first camera is then the world.",
        example="labcal fit shoot --method affine,mlp -o model.safetensors",
    )
    parser.add_argument(
        "source",
        metavar="SHOOT-or-detections.csv",
        help="a shoot, of which training views are used, or a table of dots of a target held in the hand",
    )
    parser.add_argument(
        "--method",
        required=True,
        metavar="NAME[,NAME]",
        help=f"{', '.join(method_entries())}; the first is the one to begin with. Or a method of your own, "
        "package.module:Class, with fit(X, Y) and predict(X) as those of scikit-learn",
    )
    add_output(
        parser, "MODEL", "model to write; with several methods their names are added before the ending"
    )
    parser.add_argument(
        "--detections",
        type=Path,
        metavar="FILE",
        help="detections.csv of the shoot, instead of detecting anew",
    )
    parser.add_argument(
        "--lens",
        metavar="MODEL",
        default=AUTO,
        help="lens model, or prescription, of bundle and hybrid, and of the adjustment of a hand-held target "
        f"(default {AUTO}: the simplest one that predicts held-out dots and views as well as the best)",
    )
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=TogetherAction,
        help="the target of a table of dots; a shoot brings its own; given several times: boards side by "
        "side",
    )
    add_dot_places(parser, " (of a hand-held target)")
    parser.add_argument(
        "--stage-sigma-mm",
        type=decimal,
        metavar="MM",
        help="standard deviation of the stage's places of the target along each axis, independent between "
        "views; covariances of points then hold what it adds",
    )
    parser.add_argument(
        "--stage-sigma-deg",
        type=decimal,
        metavar="DEG",
        help="the same of its rotations of the target about each axis through the target's origin",
    )
    parser.add_argument(
        "--no-rehearsal",
        action="store_true",
        help="be quick: leave out surrogate validation, that is, the expected error and the flag "
        "'model-misfit'",
    )
    add_hold_out(parser)
    add_seed(parser)
    add_page(parser)
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Fit each method and write its model."""
    from labcal.cli.dots import dots_given, refuse_idle_detection
    from labcal.cli.page import asked_page
    from labcal.correspond.dot_source import open_dots
    from labcal.correspond.paths_read import paths_read
    from labcal.errors import InputError
    from labcal.estimators.model_file import KIND, save_models
    from labcal.pipeline import FitSettings, fit_methods, training_of
    from labcal.report.fit_result import FitOutcome, fit_result, fit_table, fit_warnings
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.overwriting import require_name
    from labcal.wording import listed

    settings = FitSettings(
        arguments.lens,
        arguments.seed,
        dot_treatment(arguments),
        not arguments.no_rehearsal,
        arguments.hold_out or (),
        arguments.stage_sigma_mm,
        arguments.stage_sigma_deg,
    )
    estimators = named_estimators(arguments.method, settings)
    _refuse_idle_seed(arguments, estimators)
    require_name(arguments.output)
    alone = len(estimators) == 1
    paths = [_path(arguments.output, estimator.method, alone=alone) for estimator in estimators]
    read = paths_read([arguments.source, arguments.detections, arguments.target, arguments.lens])
    page = asked_page(arguments, session, [arguments.source, arguments.detections])
    outputs = [FileOutput(path, KIND) for path in paths] + ([] if page is None else [page.file])
    claim_outputs(outputs, read, force=arguments.force)
    refuse_idle_detection(arguments)
    given = open_dots(arguments.source, arguments.detections)
    target = _target(arguments, given)
    detections = dots_given(given, target, arguments, session)
    with session.progress() as progress:
        training = training_of(given.showing(target), detections, settings, progress)
    for warning in training.warnings:
        session.warn(warning)
    if training.held is None:
        _refuse_idle_lens(arguments, estimators)
    if training.centred.reason is not None:
        session.say(f"eccentricity is not corrected: {training.centred.reason}")
    if training.held_out:
        session.say(f"held out, to be scored by 'labcal evaluate': {listed(training.held_out)}")
    with session.progress() as progress:
        models = fit_methods(training, estimators, settings, progress)
    if alone and isinstance(models[0], InputError):
        raise models[0]
    named = list(zip(paths, estimators, models, strict=True))
    outcomes = [FitOutcome(estimator.method, path, model) for path, estimator, model in named]
    for warning in fit_warnings(outcomes):
        session.warn(warning)
    made = [(path, model) for path, _, model in named if not isinstance(model, InputError)]
    save_models(made, force=arguments.force)
    _write_page(page, training, outcomes)
    result = fit_result(training, outcomes)
    session.emit(result, fit_table(result, rehearsed=settings.rehearsal))
    if not made:
        return ExitStatus.UNUSABLE
    doubtful = result.handheld is not None and result.handheld.doubtful
    return ExitStatus.PARTIAL if len(made) < len(paths) or doubtful else ExitStatus.DONE


def _target(arguments: Namespace, given: "DotSource") -> "AnyTarget":
    """Return the target of the dots; a stage knows it."""
    from labcal.errors import InputError
    from labcal.estimators.training import on_stage

    if arguments.target is not None and given.shoot is not None and on_stage(given.shoot):
        raise InputError(
            "--target is for a hand-held target, but this shoot's target stood on a stage. Leave it out."
        )
    return given.target(arguments.target)


def _refuse_idle_seed(arguments: Namespace, estimators: "list[PointEstimator]") -> None:
    """Raise where a seed is given and nothing is random."""
    if arguments.no_rehearsal and not any("random_state" in one.get_params() for one in estimators):
        refuse_option(arguments, "seed", f"means nothing to {arguments.method}, in which nothing is random")


def _write_page(page: "PageOutput | None", training: "Training", outcomes: "list[FitOutcome]") -> None:
    """Write the page, where one is asked for."""
    if page is not None:
        from labcal.pipeline.pages import page_maker
        from labcal.report.fit_page import fit_page

        page.write(fit_page(training, outcomes, page_maker(page, "fit", {})))


def _refuse_idle_lens(arguments: Namespace, estimators: "list[PointEstimator]") -> None:
    """Raise where a lens is named for a stage, no method has one, and surrogate validation is left out."""
    has_lens = any("lens" in one.get_params() for one in estimators)
    if arguments.lens != AUTO and arguments.no_rehearsal and not has_lens:
        refuse_option(
            arguments, "lens", f"means nothing to {arguments.method} on a stage without a rehearsal"
        )


def _path(output: Path, method: str, *, alone: bool) -> Path:
    name = method.replace(":", ".")  # which file names of Windows cannot have
    return output if alone else output.with_name(f"{output.stem}-{name}{output.suffix}")
