"""Result of ``labcal fit``: the JSON document, and the same for people."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import isfinite

from rich.table import Table

from labcal.calibrate.eccentricity import CorrectedEccentricity
from labcal.cameras.blind_pixels import blind_pixels
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.expected_error import ExpectedError
from labcal.estimators.model import Model
from labcal.estimators.stage_errors import StageSigma
from labcal.estimators.training import Training
from labcal.evaluate.statistics import error_statistics
from labcal.paths import AnyPath
from labcal.report.handheld_result import HandheldResult, handheld_result


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
    expected: ExpectedError | None
    """Error to expect between the training dots, by surrogate validation; null if the dots determine no
    cameras."""
    misfit: bool
    """True if points will carry the flag ``model-misfit``."""
    error: str | None
    field_px: tuple[float, ...] | None = None
    """RMS length of the residual field by camera, 0 where none was used; null of methods without one."""
    notes: tuple[str, ...] = ()
    """Notes, for people."""


@dataclass(frozen=True)
class FitResult:
    """The JSON document of ``labcal fit``."""

    models: list[MethodResult]
    centre_bias_px: CorrectedEccentricity | None
    """Eccentricity that was corrected in the training dots; null if none was."""
    centre_bias_kept: str | None
    """Reason why it was not corrected."""
    handheld: HandheldResult | None
    """Poses of a hand-held target; null if a stage gave them."""
    warnings: list[str]
    """Warnings about the training dots."""
    calibrated_on: list[str]
    """Training views."""
    held_out: list[str]
    """Held-out views, which are to be scored."""
    stage: StageSigma | None = None
    """Stated errors of the stage, which covariances of points hold; null without."""


@dataclass(frozen=True)
class FitOutcome:
    """Outcome of the fit of one method, with the path of its model."""

    method: str
    file: AnyPath
    model: Model | InputError


def fit_result(training: Training, outcomes: Sequence[FitOutcome]) -> FitResult:
    """Return the JSON document."""
    centred = training.centred
    models = [
        _refused(one.method, str(one.model))
        if isinstance(one.model, InputError)
        else _fitted(one.model, centred.data, one.file)
        for one in outcomes
    ]
    return FitResult(
        models=models,
        centre_bias_px=centred.eccentricity,
        centre_bias_kept=centred.reason,
        handheld=handheld_result(training),
        warnings=list(training.warnings),
        calibrated_on=list(training.calibrated_on),
        held_out=list(training.held_out),
        stage=None if centred.stage is None else StageSigma(centred.stage.sigma_mm, centred.stage.sigma_deg),
    )


def fit_warnings(outcomes: Sequence[FitOutcome]) -> list[str]:
    """Return what is not as it should be with each method, for people."""
    warnings = []
    for one in outcomes:
        reasons = [str(one.model)] if isinstance(one.model, InputError) else _blind(one.model)
        warnings += [_named(one.method, reason) for reason in reasons]
    return warnings


def _refused(method: str, reason: str) -> MethodResult:
    return MethodResult(
        method, None, 0, float("nan"), None, None, None, None, expected=None, misfit=False, error=reason
    )


def _fitted(model: Model, data: TrainingData, file: AnyPath) -> MethodResult:
    estimator = model.estimator
    cameras = estimator.cameras_ if isinstance(estimator, CameraEstimator) else None
    return MethodResult(
        method=estimator.method,
        file=str(file),
        n=len(data.X),
        training_rmse_mm=error_statistics(estimator.predict(data.X), data.Y).rmse_mm,
        epochs=getattr(estimator, "n_iter_", None),
        stop_reason=getattr(estimator, "stop_reason_", None),
        lenses=None if cameras is None else tuple(camera.lens for camera in cameras),
        share_without_rays=None if cameras is None else tuple(one.share_without_rays for one in cameras),
        expected=model.rehearsed,
        misfit=model.misfit,
        error=None,
        field_px=model.field_px,
        notes=() if model.field_note is None else (model.field_note,),
    )


def _blind(model: Model) -> list[str]:
    """Return what pixels of a method's cameras see no direction, for people."""
    if not isinstance(model.estimator, CameraEstimator):
        return []
    notes = map(blind_pixels, model.cameras, model.estimator.cameras_)
    return [note for note in notes if note is not None]


def fit_table(result: FitResult, *, rehearsed: bool) -> Table:
    """Return the document for people; `rehearsed` tells whether the expected error was looked for."""
    captions = []
    limits = {model.expected.limit_mm for model in result.models if model.expected is not None}
    if limits:
        captions.append(
            "expected error: RMS between the training dots, by surrogate validation; limit by pixel noise: "
            f"{min(limits):.4f} mm"
        )
        if result.handheld is not None:
            captions.append(_adjustment_words(result))
    elif not rehearsed:
        captions.append("no expected error: surrogate validation was left out")
    else:
        captions.append(
            "no expected error: the training dots do not determine the cameras (are all on one plane?)"
        )
    if result.handheld is None:
        captions.append(_stage_words(result))
    bias = result.centre_bias_px
    if bias is not None and bias.max > 0.0:
        captions.append(f"corrected eccentricity: RMS {bias.rms:.4f} px, at most {bias.max:.4f} px")
    if result.handheld is not None:
        captions.append(result.handheld.words())
    captions += [note for model in result.models for note in model.notes]
    table = Table(
        "method",
        "dots",
        "RMS on training dots [mm]",
        "expected error [mm]",
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


def _adjustment_words(result: FitResult) -> str:
    """Return what the adjustment that placed a hand-held target adds to the expected error."""
    added = next(model.expected.adjustment_mm for model in result.models if model.expected is not None)
    if not isfinite(added):
        return "the expected error does not include errors of the adjustment that placed the target"
    return (
        f"the adjustment that placed the target adds an RMS error of {added:.4f} mm, which points share; "
        "their covariances hold it"
    )


def _stage_words(result: FitResult) -> str:
    """Return what errors of the stage add to the expected error, or that no sigma holds them."""
    if result.stage is None:
        return "errors of the stage are in no sigma: none are stated (stage-sigma-mm, stage-sigma-deg)"
    stated = f"{result.stage.mm:g} mm, {result.stage.deg:g} deg"
    added = [model.expected.stage_mm for model in result.models if model.expected is not None]
    if not added:
        return f"covariances of points hold errors of the stage ({stated})"
    return (
        f"errors of the stage ({stated}) add an RMS error of {added[0]:.4f} mm, which points share; their "
        "covariances hold it"
    )


def _expectation(model: MethodResult) -> str:
    """Return the expected error, and why points will be flagged if they will be."""
    expected = model.expected
    if expected is None:
        return ""
    text = f"{expected.rmse_mm:.4f}"
    if not model.misfit:
        return text
    if expected.too_large:
        return f"{text} model-misfit: {expected.rmse_mm / expected.limit_mm:.1f} times the limit"
    return f"{text} model-misfit: 95% ellipsoids hold {100.0 * expected.coverage95:.0f}%"


def _named(method: str, reason: str) -> str:
    """Return a reason that begins with the method, once."""
    return reason if reason.startswith(f"{method}:") else f"{method}: {reason}"
