"""Fitting of methods to the dots of a target, on a stage or in the hand (placed by a bundle adjustment)."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from labcal.arguments import (
    object_of,
    settings_of,
    wrong_type,
)
from labcal.calibrate.calibration import Calibration, calibrated
from labcal.calibrate.dot_treatment import DotTreatment
from labcal.calibrate.handheld import HandheldSettings
from labcal.calibrate.lens_candidates import AUTO
from labcal.calibrate.resection.lens_choice import camera_of_lens
from labcal.cameras.calibration_share import calibration_share
from labcal.cameras.camera import Camera
from labcal.correspond.boards_table import on_target
from labcal.correspond.detections import Detections
from labcal.correspond.training import TrainingData, training_data
from labcal.errors import InputError
from labcal.estimators.centred_training import CentredTraining, centred_training
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.fit_settings import FitSettings
from labcal.estimators.gp_field.stage_moves import StageMoves
from labcal.estimators.handheld_training import handheld_training
from labcal.estimators.method_choice import estimator_of
from labcal.estimators.model import Model, TrainingBox
from labcal.estimators.scikit_learn import clone
from labcal.estimators.stage_errors import StageSigma, stage_errors
from labcal.estimators.surrogate_validation import Surrogate, fit_unless_surrogate, surrogate_of, validate_on
from labcal.public_object import PublicObject
from labcal.run.progress import Progress, progress_of
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
