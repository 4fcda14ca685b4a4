"""``labcal fit``: a method learns from a target at known places."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.calibrate.lens_candidates import AUTO
from labcal.cli.methods import named_methods
from labcal.cli.options import add_hold_out, add_output, add_seed, add_workers, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.calibrate.centre_bias import CentreBias
    from labcal.cli.training import HandheldResult
    from labcal.correspond.training import TrainingData
    from labcal.estimators.estimator import PointEstimator
    from labcal.estimators.expected_error import ExpectedError
    from labcal.estimators.model import Model


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    from labcal.estimators.registry import method_entries

    parser = commands.add(
        "fit",
        run,
        "Fit methods to views of a target: on a stage that tells where it was, or held in the hand, where a "
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
        help="lens model, or prescription, of bundle and hybrid, and of the adjustment where the target was "
        f"held; {AUTO}, the default: held-out dots and views choose",
    )
    parser.add_argument(
        "--target", metavar="NAME", help="the target of a table of dots; a shoot tells its own"
    )
    parser.add_argument(
        "--free-dots",
        action="store_true",
        help="of a target that was held: estimate where each dot is on the print, too",
    )
    parser.add_argument(
        "--no-rehearsal",
        action="store_true",
        help="be quick: do not find out what error to expect, and never flag points 'model-misfit'",
    )
    add_hold_out(parser)
    add_seed(parser)
    add_workers(parser)


@dataclass(frozen=True)
class MethodResult:
    """One method in the JSON document of ``labcal fit``."""

    method: str
    file: str | None
    n: int
    training_rmse_mm: float
    epochs: int | None
    stop_reason: str | None
    lenses: tuple[str, ...] | None
    """Lens models by camera, of methods that have cameras."""
    share_without_rays: tuple[float, ...] | None
    """Of each camera's picture, where its lens folds."""
    expected: "ExpectedError | None"
    """What to expect between the trained dots, by a rehearsal with cameras like these; null where the dots
    determine none."""
    misfit: bool
    """Whether points will carry the flag ``model-misfit``."""
    error: str | None


@dataclass(frozen=True)
class FitResult:
    """The JSON document of ``labcal fit``."""

    models: list[MethodResult]
    centre_bias_px: "CentreBias | None"
    """Centroid minus centre, which was taken off the training dots; null where it was not."""
    centre_bias_kept: str | None
    """Why it was not."""
    handheld: "HandheldResult | None"
    """How the target was placed; null where a stage told."""
    warnings: list[str]
    """What was not as it should be with the dots that were taught."""
    calibrated_on: list[str]
    """Views that the methods were taught."""
    held_out: list[str]
    """Views that they were not, since they are to be scored."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Fit each method and write its model."""
    from labcal.cli.inputs import paths_read
    from labcal.cli.training import fit_settings, handheld_result, read_training
    from labcal.errors import InputError
    from labcal.estimators.model_file import KIND
    from labcal.pipeline import fit_methods
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.output_place import require_name
    from labcal.wording import listed

    estimators = _estimators(arguments)
    require_name(arguments.output)
    alone = len(estimators) == 1
    paths = [_path(arguments.output, estimator.method, alone=alone) for estimator in estimators]
    read = paths_read([arguments.source, arguments.detections, arguments.target, arguments.lens])
    claim_outputs([FileOutput(path, KIND) for path in paths], read, force=arguments.force)
    training = read_training(arguments, session)
    centred, handheld = training.centred, handheld_result(training)
    if handheld is None and arguments.lens != AUTO and not _uses_lens(estimators, arguments):
        refuse_option(
            arguments, "lens", f"means nothing to {arguments.method} on a stage without a rehearsal"
        )
    if centred.reason is not None:
        session.say(f"centroids are taken as they are: {centred.reason}")
    if training.held_out:
        session.say(f"left out, to be scored by 'labcal evaluate': {listed(training.held_out)}")
    with session.progress() as progress:
        learned = fit_methods(training, estimators, fit_settings(arguments), progress)
    results, fitted = [], []
    for path, estimator, model in zip(paths, estimators, learned, strict=True):
        if isinstance(model, InputError):
            if alone:
                raise model
            session.warn(_named(estimator.method, str(model)))
            results.append(_refused(estimator.method, str(model)))
        else:
            fitted.append((path, model))
            results.append(_fitted(model, centred.data, path))
            for told in _blind(model):
                session.warn(_named(estimator.method, told))
    _save_all(fitted, force=arguments.force)
    result = FitResult(
        results,
        centred.bias,
        centred.reason,
        handheld,
        list(training.warnings),
        list(training.calibrated_on),
        list(training.held_out),
    )
    session.emit(result, _table(result, rehearsed=not arguments.no_rehearsal))
    failed = len(results) - len(fitted)
    if failed == len(results):
        return ExitStatus.UNUSABLE
    doubtful = handheld is not None and (handheld.left_out or handheld.inconsistent is not None)
    return ExitStatus.PARTIAL if failed or doubtful else ExitStatus.DONE


def _estimators(arguments: Namespace) -> "list[PointEstimator]":
    """Return the methods that are named, with the options that concern them."""
    from labcal.cli.training import fit_settings
    from labcal.errors import InputError
    from labcal.pipeline import estimators_of

    estimators = estimators_of(named_methods(arguments.method), fit_settings(arguments))
    if len({one.method for one in estimators}) < len(estimators):
        raise InputError(f"--method names a method twice: {arguments.method}. Name each once.")
    if arguments.no_rehearsal and not any("random_state" in one.get_params() for one in estimators):
        refuse_option(arguments, "seed", f"means nothing to {arguments.method}, in which nothing is random")
    return estimators


def _uses_lens(estimators: "list[PointEstimator]", arguments: Namespace) -> bool:
    """Tell whether a method has a lens model, or a rehearsal uses one."""
    return not arguments.no_rehearsal or any("lens" in one.get_params() for one in estimators)


def _save_all(models: "list[tuple[Path, Model]]", *, force: bool) -> None:
    """Write all models or, where the disk refuses one, leave none that was not there before."""
    from labcal.errors import OutputError
    from labcal.estimators.model_file import save_model

    written: list[Path] = []
    try:
        for path, model in models:
            new = not path.exists()
            save_model(path, model, force=force)
            written += [path] if new else []
    except OutputError:
        for path in written:
            path.unlink()
        raise


def _path(output: Path, method: str, *, alone: bool) -> Path:
    name = method.replace(":", ".")  # which file names of Windows cannot have
    return output if alone else output.with_name(f"{output.stem}-{name}{output.suffix}")


def _refused(method: str, reason: str) -> MethodResult:
    return MethodResult(
        method, None, 0, float("nan"), None, None, None, None, expected=None, misfit=False, error=reason
    )


def _fitted(model: "Model", data: "TrainingData", path: Path) -> MethodResult:
    from labcal.estimators.camera_estimator import CameraEstimator
    from labcal.evaluate.statistics import error_statistics

    estimator = model.estimator
    cameras = estimator.cameras_ if isinstance(estimator, CameraEstimator) else None
    return MethodResult(
        method=estimator.method,
        file=str(path),
        n=len(data.X),
        training_rmse_mm=error_statistics(estimator.predict(data.X), data.Y).rmse_mm,
        epochs=getattr(estimator, "n_iter_", None),
        stop_reason=getattr(estimator, "stop_reason_", None),
        lenses=None if cameras is None else tuple(camera.lens for camera in cameras),
        share_without_rays=None if cameras is None else tuple(one.share_without_rays for one in cameras),
        expected=model.rehearsed,
        misfit=model.misfit,
        error=None,
    )


def _blind(model: "Model") -> list[str]:
    """Return what pixels of a method's cameras see no direction, for people."""
    from labcal.cameras.blind_pixels import blind_pixels
    from labcal.estimators.camera_estimator import CameraEstimator

    if not isinstance(model.estimator, CameraEstimator):
        return []
    told = map(blind_pixels, model.cameras, model.estimator.cameras_)
    return [note for note in told if note is not None]


def _table(result: FitResult, *, rehearsed: bool) -> object:
    from rich.table import Table

    captions = []
    limits = {model.expected.limit_mm for model in result.models if model.expected is not None}
    if limits:
        captions.append(
            "to expect: RMS error between the trained dots, rehearsed with cameras like these; what pixels "
            f"scatter leaves {min(limits):.4f} mm"
        )
        if result.handheld is not None:
            captions.append("on top of that comes what the adjustment that placed the target is off")
    elif not rehearsed:
        captions.append("not rehearsed, so that no error to expect is told")
    else:
        captions.append("no error to expect is told: the dots, all on one plane perhaps, determine no camera")
    if result.centre_bias_px is not None:
        bias = result.centre_bias_px
        captions.append(f"taken off: centroid minus centre, RMS {bias.rms:.4f} px, at most {bias.max:.4f} px")
    if result.handheld is not None:
        captions.append(result.handheld.words())
    table = Table(
        "method",
        "dots",
        "RMS on the trained dots [mm]",
        "to expect [mm]",
        "epochs",
        "model",
        caption="\n".join(captions),
        caption_justify="left",
    )
    table.columns[-1].overflow = "fold"  # the next command needs the whole name
    for model in result.models:
        if model.error is not None:
            table.add_row(model.method, "", "", "", "", "refused")
            continue
        epochs = "" if model.epochs is None else f"{model.epochs} ({model.stop_reason})"
        table.add_row(
            model.method,
            str(model.n),
            f"{model.training_rmse_mm:.4f}",
            _expectation(model),
            epochs,
            str(model.file),
        )
    return table


def _expectation(model: MethodResult) -> str:
    """Return what to expect, and why points are flagged where they are."""
    expected = model.expected
    if expected is None:
        return ""
    told = f"{expected.rmse_mm:.4f}"
    if not model.misfit:
        return told
    if expected.too_large:
        return f"{told} model-misfit: {expected.rmse_mm / expected.limit_mm:.1f} times what pixels leave"
    return f"{told} model-misfit: 95% ellipsoids hold {100.0 * expected.coverage95:.0f}%"


def _named(method: str, reason: str) -> str:
    """Return a reason that begins with the method, once."""
    return reason if reason.startswith(f"{method}:") else f"{method}: {reason}"
