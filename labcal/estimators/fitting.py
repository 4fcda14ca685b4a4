"""Fitting of methods to training data."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from labcal.arguments import (
    object_of,
    settings_of,
    wrong_type,
)
from labcal.calibrate.lens_candidates import AUTO
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.cameras.calibration_share import calibration_share
from labcal.cameras.camera import Camera
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.fit_settings import FitSettings
from labcal.estimators.gp_field.stage_moves import StageMoves
from labcal.estimators.method_choice import estimator_of
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.scikit_learn import clone
from labcal.estimators.surrogate_validation import Surrogate, fit_unless_surrogate, surrogate_of, validate_on
from labcal.estimators.training import Training
from labcal.run.progress import Progress, progress_of


def estimators_of(methods: Sequence[object], settings: FitSettings | None = None) -> list[PointEstimator]:
    """Return estimators with the settings that concern them.

    Parameters
    ----------
    methods : sequence of str, type or object
        As for :func:`~labcal.estimators.method_choice.estimator_of`. An estimator of labcal's that is given
        ready keeps its own parameters.
    settings : FitSettings, optional

    Returns
    -------
    list of PointEstimator
        In the order of `methods`, not yet fitted.

    Raises
    ------
    UnknownNameError
        There is no such method or lens.
    InputError
        As of :func:`~labcal.estimators.method_choice.estimator_of`.

    Examples
    --------
    >>> from labcal.pipeline import FitSettings, estimators_of
    >>> hybrid, mlp = estimators_of(["hybrid", "mlp"], FitSettings(lens="brown5", seed=7))
    >>> hybrid.lens, mlp.random_state
    ('brown5', 7)
    """
    settings = settings_of(settings, FitSettings)
    if isinstance(methods, str):
        methods = [methods]
    if not isinstance(methods, Sequence):
        raise wrong_type(methods, "a sequence of methods", "methods")
    estimators = [estimator_of(method) for method in methods]
    if settings.lens != AUTO:
        camera_of_lens(settings.lens, (1, 1), None)  # raises now if there is no such lens
    wanted = {"random_state": settings.seed, "lens": settings.lens}
    for method, estimator in zip(methods, estimators, strict=True):
        if isinstance(method, PointEstimator):
            continue
        known = estimator.get_params()
        estimator.set_params(**{key: value for key, value in wanted.items() if key in known})
    return estimators


def fit_methods(
    training: Training,
    estimators: Sequence[PointEstimator],
    settings: FitSettings | None = None,
    progress: Progress | None = None,
) -> list[Model | InputError]:
    """Return the fitted model of each method, or the error that prevents it.

    Parameters
    ----------
    training : Training
        As :func:`training_of` returns it.
    estimators : sequence of PointEstimator
        As :func:`estimators_of` returns them. They are not changed; copies are fitted.
    settings : FitSettings, optional
    progress : Progress, optional

    Returns
    -------
    list of Model or InputError
        In the order of `estimators`. An error is returned and not raised, so that the other methods are
        fitted all the same.

    Examples
    --------
    >>> from labcal import examples, load_target, pipeline
    >>> settings = pipeline.FitSettings(lens="brown5", rehearsal=False)
    >>> training = pipeline.training_of(load_target(examples.TARGET), examples.detections(), settings)
    >>> methods = pipeline.estimators_of(["affine", "dlt"], settings)
    >>> [model.estimator.method for model in pipeline.fit_methods(training, methods, settings)]
    ['affine', 'dlt']
    """
    settings, progress = settings_of(settings, FitSettings), progress_of(progress)
    if isinstance(estimators, str) or not isinstance(estimators, Sequence):
        raise wrong_type(estimators, "a sequence, as estimators_of returns it", "estimators")
    for one in estimators:
        if not isinstance(one, PointEstimator):
            raise wrong_type(one, "estimators, as estimators_of returns them", "estimators")
    data, fitted = object_of(training, Training, "training").centred.data, list[Model | InputError]()
    progress.start("methods", len(estimators) + 1)
    surrogate = None
    if settings.rehearsal:
        moves = training.centred.moves
        surrogate = surrogate_of(data.X, data.Y, data.image_sizes, settings.seed, settings.lens, moves)
    adjustment_mm = 0.0 if surrogate is None else _adjustment_mm(training, surrogate)
    stage_mm = 0.0 if surrogate is None else _stage_mm(training, surrogate)
    progress.advance()
    for estimator in estimators:
        try:
            centred = training.centred
            model = fit_method(data, estimator, centred.cameras, surrogate, centred.moves)
            fitted.append(_with_its_origin(model, training, adjustment_mm, stage_mm))
        except InputError as error:
            fitted.append(error)
        progress.advance()
    return fitted


def _adjustment_mm(training: Training, surrogate: Surrogate) -> float:
    """Return the RMS error that the adjustment of a hand-held target adds to the points of a surrogate."""
    centred = training.centred
    if training.held is None:
        return 0.0
    if centred.cameras is None or centred.covariance is None:
        return float("nan")
    share = calibration_share(centred.cameras, centred.covariance.matrix, surrogate.p, surrogate.covariance)
    return float(np.sqrt(np.trace(share, axis1=1, axis2=2).mean()))


def _stage_mm(training: Training, surrogate: Surrogate) -> float:
    """Return the RMS error that a stage's readings add to the points of a surrogate."""
    centred = training.centred
    if training.held is not None:
        return 0.0
    if centred.cameras is None or centred.stage is None:
        return float("nan")
    share = centred.stage.share(centred.cameras, surrogate.p, surrogate.covariance)
    return float(np.sqrt(np.trace(share, axis1=1, axis2=2).mean()))


def _with_its_origin(model: Model, training: Training, adjustment_mm: float, stage_mm: float) -> Model:
    """Return a model that tells what it was fitted to, and what that adds to its errors."""
    centred, expected = training.centred, model.rehearsed
    return replace(
        model,
        rehearsed=None
        if expected is None
        else replace(expected, adjustment_mm=adjustment_mm, stage_mm=stage_mm),
        calibration=centred.calibration,
        covariance=centred.covariance,
        calibrated_on=training.calibrated_on,
        held_out=training.held_out,
        warnings=training.warnings,
        stage=centred.stage,
    )


def fit_method(
    data: TrainingData,
    estimator: PointEstimator,
    resected: tuple[Camera, ...] | None = None,
    surrogate: Surrogate | None = None,
    moves: StageMoves | None = None,
) -> Model:
    """Fit one method to pixels and points.

    Parameters
    ----------
    data : TrainingData
    estimator : PointEstimator
        It is not changed; a copy is fitted.
    resected : tuple of Camera, optional
        Of the training where its pixels are those of centres.
    surrogate : Surrogate, optional
        The surrogate on which the method is validated.
    moves : StageMoves, optional
        Stated errors of the stage, which the field of `hybrid` does not explain.

    Raises
    ------
    InputError
        The method cannot be fitted to these data.
    """
    estimator = clone(estimator)
    if "image_sizes" in estimator.get_params():
        estimator.set_params(image_sizes=data.image_sizes)
    box = TrainingBox.of(data.X, data.Y)
    fitted = fit_unless_surrogate(surrogate, estimator, data.X, data.Y, moves)
    rehearsed = None if surrogate is None else validate_on(fitted, surrogate)
    return Model(fitted, data.cameras, data.image_sizes, box, resected, rehearsed)
