"""Work of one part of the views: fit every method to the others, and measure it on these."""

from dataclasses import replace

import numpy as np
from numpy.linalg import LinAlgError

from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.distortion.own_detections.case import OwnCase
from labcal.bench.distortion.preparation import prepared_method
from labcal.bench.distortion.region_counts import region_counts
from labcal.bench.distortion.sensible_places import sensible_places
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, stage_points
from labcal.correspond.points import PointFlag
from labcal.errors import InputError, LabcalError
from labcal.estimators.fit_settings import FitSettings
from labcal.estimators.fitting import fit_method
from labcal.estimators.model import Model
from labcal.estimators.surrogate_validation import Surrogate, surrogate_of
from labcal.estimators.training import Training, training_of
from labcal.reconstruct.reconstruction import reconstruct_centres
from labcal.run.threads import one_blas_thread

HELD_OUT = "held-out"
"""The region of points of views that were not trained on."""


@one_blas_thread()
def measured_views(case: OwnCase) -> CaseFigures:
    """Return the figures of all methods on views held out; a method that refuses has its reason there.

    The way of the pixels is that of ``labcal fit`` and ``labcal reconstruct``, with the eccentricity
    corrected in both. Errors are against the places that the stage gives.

    Raises
    ------
    InputError, UnknownNameError
        The views have no dots to learn from or to measure, or there is no such method.
    """
    is_held_out = np.isin(case.detections.view, case.held_out)
    tests = case.detections.where(is_held_out)
    if len(match(tests, case.shoot.cameras)) == 0:
        raise InputError("No dot of the views held out was measured by all cameras.")
    training = training_of(case.shoot, case.detections.where(~is_held_out), FitSettings(seed=case.seed))
    data = training.centred.data
    surrogate = surrogate_of(data.X, data.Y, data.image_sizes, case.seed)
    methods = tuple(_measured_method(case, method, training, tests, surrogate) for method in case.methods)
    return CaseFigures(trained=len(data.Y), methods=methods)


def _measured_method(
    case: OwnCase, method: str, training: Training, tests: Detections, surrogate: Surrogate | None
) -> MethodFigures:
    data = training.centred.data
    estimator = prepared_method(method, case.settings.get(method, {}), case.seed, data.image_sizes)
    try:
        model = fit_method(data, estimator, training.centred.cameras, surrogate)
        model = replace(model, calibration=training.centred.calibration)
        figures = _figures(case, model, tests)
    except (LabcalError, LinAlgError) as error:
        return MethodFigures(method=method, reason=f"{type(error).__name__}: {error}")
    expected = model.rehearsed
    if expected is None:
        return MethodFigures(method=method, regions=(figures,))
    return MethodFigures(
        method=method, regions=(figures,), misfit=expected.misfit, expected_mm=expected.rmse_mm
    )


def _figures(case: OwnCase, model: Model, tests: Detections) -> RegionFigures:
    found = reconstruct_centres(model, tests, case.shoot.target).points
    dots = match(tests, case.shoot.cameras)  # the lines of `found`
    error = sensible_places(found.point) - stage_points(dots, case.shoot.target, case.shoot.nominal_poses())
    return region_counts(HELD_OUT, error, found.covariance, found.flag == PointFlag.EXTRAPOLATED.value)
