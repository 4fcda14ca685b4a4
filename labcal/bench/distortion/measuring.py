"""Work of one case: fit every method, and measure it on points that were not trained on."""

import time

from numpy.linalg import LinAlgError

from labcal.bench.distortion.case import Case, Measured
from labcal.bench.distortion.cell_data import CellData, cell_data
from labcal.bench.distortion.figures import CaseFigures, MethodFigures, RegionFigures
from labcal.bench.distortion.preparation import prepared_method
from labcal.bench.distortion.region_counts import region_counts
from labcal.bench.distortion.rendered_data import rendered_data
from labcal.bench.distortion.sensible_places import sensible_places
from labcal.bench.families.cameras import SIZE
from labcal.errors import DeviceError, LabcalError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.model import TrainingBox
from labcal.estimators.surrogate_validation import (
    Surrogate,
    fit_unless_surrogate,
    surrogate_of,
    takes_from,
    validate_on,
)
from labcal.run.threads import one_blas_thread

_SIZES = (SIZE, SIZE)


@one_blas_thread()
def measured_case(case: Case) -> CaseFigures:
    """Return the figures of all methods of a case.

    A method that refuses the data has its reason there, and so has a case whose data cannot be drawn.

    Raises
    ------
    UnknownNameError, InputError
        There is no such method, or it cannot be made.
    """
    estimators = [prepared(case, method) for method in case.methods]
    try:
        data = cell_data(case) if case.pictures is None else rendered_data(case, case.pictures)
    except DeviceError:  # of this machine: another one, or another run, may do it
        raise
    except LabcalError as error:
        return CaseFigures(reason=str(error))
    surrogate = surrogate_of(data.X, data.Y, _SIZES, case.seed)
    methods = tuple(
        _measured_method(case, method, estimator, data, surrogate)
        for method, estimator in zip(case.methods, estimators, strict=True)
    )
    return CaseFigures(
        trained=len(data.Y),
        beyond_pinhole_px=data.beyond_pinhole_px,
        pixel_error_px=data.pixel_error_px,
        methods=methods,
    )


def prepared(case: Case, method: str) -> PointEstimator:
    """Return a new estimator of a method with the settings of the plan, the pictures' sizes and the seed.

    Raises
    ------
    UnknownNameError, InputError
        There is no such method, or it cannot be made.
    """
    return prepared_method(method, case.settings.get(method, {}), case.seed, _SIZES)


def _measured_method(
    case: Case, method: str, estimator: PointEstimator, data: CellData, surrogate: Surrogate | None
) -> MethodFigures:
    shared = 0.0
    if surrogate is not None and takes_from(surrogate, estimator):
        shared = surrogate.hybrid_seconds
    try:
        began = time.perf_counter()
        estimator = fit_unless_surrogate(surrogate, estimator, data.X, data.Y)
        own = time.perf_counter() - began
        regions = tuple(region_figures(estimator, data, region) for region in case.regions)
        expected = None if surrogate is None else validate_on(estimator, surrogate)
    except (LabcalError, LinAlgError) as error:
        return MethodFigures(method=method, reason=f"{type(error).__name__}: {error}")
    found = MethodFigures(method=method, regions=regions, fit_seconds=own, shared_seconds=shared)
    if expected is None:
        return found
    return found.model_copy(update={"misfit": expected.misfit, "expected_mm": expected.rmse_mm})


def region_figures(estimator: PointEstimator, data: CellData, region: Measured) -> RegionFigures:
    """Return errors and coverage of a fitted method at the points of a region.

    Parameters
    ----------
    estimator : PointEstimator
        Fitted.
    data : CellData
    region : Measured
    """
    tests = data.tests[region]
    X = tests.q.reshape(len(tests.q), -1)
    began = time.perf_counter()
    found, stated = estimator.predict_with_covariance(X, tests.covariance)
    seconds = time.perf_counter() - began
    found = sensible_places(found)
    outside = ~TrainingBox.of(data.X, data.Y).holds(found)
    figures = region_counts(str(region), found - tests.p, stated, outside, tests.oracle - tests.p)
    return figures.model_copy(update={"predict_seconds": seconds})
