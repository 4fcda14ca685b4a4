"""``labcal fit``: a method learns from a target at known places."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import add_output, add_seed, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.correspond.training import TrainingData
    from labcal.solve.centre_bias import CentreBias
    from labcal.solve.fitted_model import FittedModel


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "fit",
        run,
        "Fit methods to the training views of a shoot whose stage tells where the target was.",
        example="labcal fit shoot --method affine,mlp -o model.safetensors",
    )
    parser.add_argument("shoot", type=Path, metavar="SHOOT")
    parser.add_argument(
        "--method",
        required=True,
        metavar="NAME[,NAME]",
        help="affine, quadratic, homography, dlt, mlp, mlp-bayes, ray-net",
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
    error: str | None


@dataclass(frozen=True)
class FitResult:
    """The JSON document of ``labcal fit``."""

    models: list[MethodResult]
    centre_bias_px: "CentreBias | None"
    """Centroid minus centre, which was taken off the training dots; null where it was not."""
    centre_bias_kept: str | None
    """Why it was not."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Fit each method and write its model."""
    from labcal.cli.inputs import read_or_detect
    from labcal.correspond.detections import read_detections
    from labcal.errors import InputError
    from labcal.run.outputs import refuse_existing, refuse_homeless
    from labcal.shoot.dataset import open_shoot
    from labcal.solve.registry import make_estimator
    from labcal.workflow import centred_training, fit, training_data

    names = arguments.method.split(",")
    if len(set(names)) < len(names):
        raise InputError(f"--method names a method twice: {arguments.method}. Name each once.")
    estimators = [make_estimator(name) for name in names]
    paths = [_path(arguments.output, name, alone=len(names) == 1) for name in names]
    for path in paths:
        refuse_existing(path, force=arguments.force)
        refuse_homeless(path)
    shoot = open_shoot(arguments.shoot)
    detections = (
        read_detections(arguments.detections)
        if arguments.detections is not None
        else read_or_detect(str(arguments.shoot), None, arguments.workers, session)
    )
    training = centred_training(training_data(shoot, detections), shoot.target, shoot.nominal_poses())
    data = training.data
    if training.reason is not None:
        session.say(f"centroids are taken as they are: {training.reason}")
    results, fitted = [], []
    for path, estimator in zip(paths, estimators, strict=True):
        if "random_state" in estimator.get_params():
            estimator.set_params(random_state=arguments.seed)
        try:
            model = fit(data, estimator, training.cameras)
        except InputError as error:
            if len(names) == 1:
                raise
            session.warn(f"{estimator.method}: {error}")
            results.append(_refused(estimator.method, str(error)))
            continue
        fitted.append((path, model))
        results.append(_fitted(model, data, path))
    _save_all(fitted, force=arguments.force)
    result = FitResult(results, training.bias, training.reason)
    session.emit(result, _table(result))
    failed = sum(model.error is not None for model in results)
    if failed == len(results):
        return ExitStatus.UNUSABLE
    return ExitStatus.PARTIAL if failed else ExitStatus.DONE


def _save_all(models: "list[tuple[Path, FittedModel]]", *, force: bool) -> None:
    """Write all models or, where the disk refuses one, leave none that was not there before."""
    from labcal.errors import OutputError
    from labcal.solve.model_file import save_model

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
    return output if alone else output.with_name(f"{output.stem}-{method}{output.suffix}")


def _refused(method: str, reason: str) -> MethodResult:
    return MethodResult(method, None, 0, float("nan"), None, None, reason)


def _fitted(model: "FittedModel", data: "TrainingData", path: Path) -> MethodResult:
    from labcal.evaluate.statistics import error_statistics

    estimator = model.estimator
    return MethodResult(
        method=estimator.method,
        file=str(path),
        n=len(data.X),
        training_rmse_mm=error_statistics(estimator.predict(data.X), data.Y).rmse_mm,
        epochs=getattr(estimator, "n_iter_", None),
        stop_reason=getattr(estimator, "stop_reason_", None),
        error=None,
    )


def _table(result: FitResult) -> object:
    from rich.table import Table

    caption = None
    if result.centre_bias_px is not None:
        bias = result.centre_bias_px
        caption = f"taken off: centroid minus centre, RMS {bias.rms:.4f} px, at most {bias.max:.4f} px"
    table = Table("method", "dots", "RMS on the trained dots [mm]", "epochs", "model", caption=caption)
    for model in result.models:
        epochs = "" if model.epochs is None else f"{model.epochs} ({model.stop_reason})"
        fate = model.error or str(model.file)
        table.add_row(model.method, str(model.n), f"{model.training_rmse_mm:.4f}", epochs, fate)
    return table
