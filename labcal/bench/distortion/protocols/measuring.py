"""Work of one case of a protocol: fit every method, and measure it as the authors did."""

import numpy as np
from numpy.linalg import LinAlgError

from labcal.bench.distortion.checks import HYBRID
from labcal.bench.distortion.preparation import prepared_method
from labcal.bench.distortion.protocols.case import ProtocolCase
from labcal.bench.distortion.protocols.figures import ORACLE, ProtocolCaseFigures, ProtocolMethodFigures
from labcal.bench.distortion.protocols.protocol import Protocol, ProtocolData
from labcal.bench.distortion.protocols.registry import protocol_by_name
from labcal.bench.distortion.sensible_places import sensible_places
from labcal.errors import LabcalError
from labcal.estimators.estimator import PointEstimator
from labcal.estimators.surrogate_validation import Surrogate, fit_unless_surrogate, surrogate_of, validate_on
from labcal.evaluate.statistics import coverage
from labcal.run.threads import one_blas_thread


@one_blas_thread()
def measured_protocol(case: ProtocolCase) -> ProtocolCaseFigures:
    """Return the figures of exact cameras and of all methods; a method that refuses has its reason there.

    Raises
    ------
    LabcalError
        There is no such protocol or method, or the data cannot be made.
    """
    protocol = protocol_by_name(case.protocol)
    data = protocol.data(case.seed)
    oracle = ProtocolMethodFigures(method=ORACLE, values=tuple(protocol.figures(data.oracle, data)))
    surrogate = None
    if HYBRID in case.methods:  # which it is made of: it costs next to nothing then
        surrogate = surrogate_of(data.X, data.Y, data.image_sizes, case.seed)
    methods = []
    for method in case.methods:
        settings = case.settings.get(method, {})
        estimator = prepared_method(method, settings, case.seed, data.image_sizes)
        methods.append(_measured_method(protocol, data, method, estimator, surrogate))
    return ProtocolCaseFigures(methods=(oracle, *methods))


def _measured_method(
    protocol: Protocol,
    data: ProtocolData,
    method: str,
    estimator: PointEstimator,
    surrogate: Surrogate | None,
) -> ProtocolMethodFigures:
    try:
        fitted = fit_unless_surrogate(surrogate, estimator, data.X, data.Y)
        expected = None if surrogate is None else validate_on(fitted, surrogate)
        found, stated = fitted.predict_with_covariance(data.q.reshape(len(data.q), -1), data.covariance)
    except (LabcalError, LinAlgError) as error:
        return ProtocolMethodFigures(method=method, reason=f"{type(error).__name__}: {error}")
    found = sensible_places(found)
    if not np.isfinite(found).all(axis=1).any():
        return ProtocolMethodFigures(method=method, reason="the method gives no place for any point")
    return ProtocolMethodFigures(
        method=method,
        values=tuple(protocol.figures(found, data)),
        coverage95=coverage(found - data.p, stated),
        misfit=None if expected is None else expected.misfit,
    )
