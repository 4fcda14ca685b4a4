"""The page of ``labcal fit``: the verdict, methods side by side, errors over the volume, learning curves."""

from collections.abc import Sequence

import numpy as np

from labcal.cameras.camera import Camera
from labcal.estimators.camera_estimator import CameraEstimator
from labcal.estimators.model import Model
from labcal.estimators.training import Training
from labcal.evaluate.verdict.amounts import at_distance
from labcal.evaluate.verdict.of_fit import FitEvidence, MethodEvidence, fit_verdict
from labcal.evaluate.working_distance import usual_distance
from labcal.report.error_map import error_map
from labcal.report.fit_result import FitOutcome, FitResult, MethodResult, fit_result, fit_warnings
from labcal.report.learning_curves import learning_curves
from labcal.report.page.beside import Beside
from labcal.report.page.chart import Chart
from labcal.report.page.document import Page, Section
from labcal.report.page.download import Download, table_download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose
from labcal.report.page.space_view import SpaceView
from labcal.report.page.statement import Statement
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page_maker import PageMaker
from labcal.report.residual_map import residual_magnification, residual_map
from labcal.report.space import Space
from labcal.wording import counted, listed


def fit_page(training: Training, outcomes: Sequence[FitOutcome], maker: PageMaker) -> Page:
    """Return the page of methods fitted to the same dots.

    Parameters
    ----------
    training : Training
    outcomes : sequence of FitOutcome
    maker : PageMaker
    """
    result = fit_result(training, outcomes)
    models = [one.model for one in outcomes if isinstance(one.model, Model)]
    evidence = _evidence(training, result, models)
    best = next(
        (model for model in models if evidence.best and model.estimator.method == evidence.best.method), None
    )
    sections = [Section("Methods", [_method_table(result.models)])]
    if best is not None:
        sections += _error_sections(training, best)
    curves = {
        model.estimator.method: np.asarray(history)
        for model in models
        if (history := getattr(model.estimator, "history_", None)) is not None
    }
    if curves:
        chart = Chart("learning", learning_curves(curves), _LEARNING, _curve_file(curves))
        sections.append(Section("Learning curves", [chart]))
    data = training.centred.data
    return Page(
        title=f"Fit of {listed([one.method for one in outcomes])}",
        heading=f"Fit of {listed([one.method for one in outcomes])}",
        lead=f"{counted(len(data.Y), 'dot')} of {counted(len(training.calibrated_on), 'view')}, seen by "
        f"{listed(data.cameras)}; {_placed(result)}.",
        sections=sections,
        provenance=maker.provenance,
        opening=[
            Statement(fit_verdict(evidence), maker.phrase),
            *maker.notes([*training.warnings, *fit_warnings(outcomes)]),
        ],
    )


_TRAINED = (
    "On the dots that the method was fitted to, where its errors are smallest: between them they are larger, "
    "and outside the trained volume they have no bound."
)
_LEARNING = (
    "Mean squared error of the scaled outputs on the training dots. A curve that still falls at its end was "
    "stopped early."
)
_RESIDUALS = (
    "Images of the training dots by the fitted cameras minus the measured ones. Thick arrows are means of "
    "cells: those that point the same way as their neighbours show what the lens model does not explain."
)


def _placed(result: FitResult) -> str:
    """Return what gave the places of the target."""
    return "a stage gave its places" if result.handheld is None else "a bundle adjustment placed it"


def _evidence(training: Training, result: FitResult, models: Sequence[Model]) -> FitEvidence:
    Y = training.centred.data.Y
    sides = " x ".join(f"{side:.0f}" for side in np.ptp(Y, axis=0).tolist())
    doubt = None if result.handheld is None else result.handheld.inconsistent
    methods = [
        MethodEvidence(one.method, one.n, one.training_rmse_mm, one.expected)
        for one in result.models
        if one.error is None
    ]
    return FitEvidence(
        methods=methods,
        volume=f"within the trained volume of {sides} mm{at_distance(_distance(training, models))}",
        validated=any(model.rehearsed is not None for model in models),
        causes=() if doubt is None else tuple(cause.cause for cause in doubt.causes),
    )


def _distance(training: Training, models: Sequence[Model]) -> float | None:
    """Return the median distance of the training dots from the cameras, mm, where a method has cameras."""
    found = [cameras for model in models if (cameras := _cameras(model))]
    return usual_distance(found[0].values(), training.centred.data.Y) if found else None


def _cameras(model: Model) -> dict[str, Camera]:
    """Return the cameras of a method or, where it has none, those that its training dots determine."""
    if isinstance(model.estimator, CameraEstimator):
        return dict(zip(model.cameras, model.estimator.cameras_, strict=True))
    return dict(zip(model.cameras, model.resected or (), strict=False))


def _method_table(methods: Sequence[MethodResult]) -> PageTable:
    columns = [
        Column("method", Side.LEFT),
        Column("dots"),
        Column("RMS on the trained dots, mm"),
        Column(
            "to expect between them, mm", meaning="RMS error by surrogate validation, on cameras like these"
        ),
        Column("noise alone, mm", meaning="What exactly known cameras leave"),
        Column("in 95% ellipsoids"),
        Column("epochs"),
        Column("remarks", Side.WIDE),
    ]
    rows = []
    for one in methods:
        if one.error is not None:
            rows.append([one.method, *[MISSING] * 6, f"refused: {one.error}"])
            continue
        expected = one.expected
        figures = [MISSING] * 3
        if expected is not None:
            figures = [
                f"{expected.rmse_mm:.4f}",
                f"{expected.limit_mm:.4f}",
                f"{100 * expected.coverage95:.0f}%",
            ]
        remarks = ["model-misfit"] if one.misfit else []
        remarks += [] if one.stop_reason is None else [one.stop_reason]
        remarks += [] if one.lenses is None else [f"lenses {', '.join(one.lenses)}"]
        remarks += [note.removeprefix(f"{one.method}: ") for note in one.notes]
        epochs = MISSING if one.epochs is None else str(one.epochs)
        rows.append(
            [one.method, str(one.n), f"{one.training_rmse_mm:.4f}", *figures, epochs, "; ".join(remarks)]
        )
    return PageTable("methods-table", "Methods, fitted to the same dots.", columns, rows)


def _error_sections(training: Training, model: Model) -> list[Section]:
    """Return where the best method errs on the training dots: in space, over the volume, in the pictures."""
    data, method = training.centred.data, model.estimator.method
    predicted = np.asarray(model.estimator.predict(data.X)[:, :3])
    ok = np.isfinite(predicted).all(axis=1)
    Y, error = data.Y[ok], predicted[ok] - data.Y[ok]
    labels = [
        f"{view}, dot {col}, {row}" for view, (col, row) in zip(data.view[ok], data.index[ok], strict=True)
    ]
    space = Space(_cameras(model), [], Y + error, -error, labels)
    said = f"The training dots as '{method}' gives them. An error vector leads from a point to its dot."
    figures = np.round(np.concatenate([Y, error], axis=1).T, 5).tolist()
    header = ("view", "col", "row", "X_mm", "Y_mm", "Z_mm", "X_error_mm", "Y_error_mm", "Z_error_mm")
    columns = (data.view[ok].tolist(), *data.index[ok].T.tolist(), *figures)
    file = table_download("errors.csv", header, columns)
    volume = Chart(
        "error-map", error_map(Y, np.linalg.norm(error, axis=1)), f"RMS error of '{method}'. {_TRAINED}", file
    )
    found = [Section("In space", [SpaceView("space", space, said)]), Section("Over the volume", [volume])]
    residuals = _residual_parts(training, model)
    if residuals:
        found.append(Section("Residuals", [Prose((_RESIDUALS,)), Beside(tuple(residuals))]))
    return found


def _residual_parts(training: Training, model: Model) -> list[Part]:
    """Return the residuals of a method with cameras, over each picture."""
    if not isinstance(model.estimator, CameraEstimator):
        return []
    data = training.centred.data
    measured = data.X.reshape(len(data.X), -1, 2)
    cameras = model.estimator.fitted_cameras_
    residuals = [camera.project(data.Y) - measured[:, i] for i, camera in enumerate(cameras)]
    widest = max(width for width, _ in model.image_sizes)
    times = residual_magnification(np.concatenate(residuals), widest)
    parts: list[Part] = []
    for number, (name, residual) in enumerate(zip(model.cameras, residuals, strict=True)):
        ok = np.isfinite(residual).all(axis=1)
        none = np.zeros(int(ok.sum()), dtype=bool)
        svg = residual_map(name, measured[ok, number], residual[ok], none, model.image_sizes[number], times)
        parts.append(
            Chart(f"residuals-{name}", svg, f"{name}: residuals of {int(ok.sum())} dots over the picture.")
        )
    return parts


def _curve_file(curves: dict[str, np.ndarray]) -> Download:
    lines = [
        (name, epoch, float(error)) for name, errors in curves.items() for epoch, error in enumerate(errors)
    ]
    return table_download("learning.csv", ("method", "epoch", "mse"), list(zip(*lines, strict=True)))
