"""The distance of two points, with the uncertainty that follows from their joint covariance."""

import numpy as np

from labcal.errors import InputError
from labcal.reconstruct.chosen_lines import OnePoint
from labcal.reconstruct.chosen_points import AnyReconstruction, ChosenPoints
from labcal.reconstruct.measured import Measured


def distance(found: AnyReconstruction, one: OnePoint, other: OnePoint) -> Measured:
    """Return the distance of two points of a rig, mm.

    Errors of the calibration move near points alike, so that their distance is known far better than either
    of them. An error of scale stays: of the target's print as a whole no view tells.

    Parameters
    ----------
    found : Reconstruction or NamedReconstruction
    one, other : int, str or (str, str)
        Lines of the points in ``found.points``; of named points also their names, with the view before the
        name where several views have it: ``("loaded", "tip")``.

    Returns
    -------
    Measured
        Mm; its sigma and the shares of noise and calibration in it.

    Raises
    ------
    InputError, InputTypeError
        There is no such line or name, the points are one, one has no solution, or they are not those of a
        rig.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> rig = pipeline.calibrate(examples.TARGET, examples.detections(), "brown5").rig
    >>> found = pipeline.reconstruct(rig, examples.detections(), examples.TARGET)
    >>> length = labcal.distance(found, 0, 10)
    >>> length.unit, length.budget.value, length.noise_sigma < length.sigma
    ('mm', 'full', True)
    """
    points = ChosenPoints.single(found, (one, other), ("one", "other"))
    along = points.point[1] - points.point[0]
    length = float(np.linalg.norm(along))
    if length == 0.0:
        raise InputError("Both points are in the same place: their distance has no first derivative.")
    unit = along / length
    return Measured.of(length, points.shares(np.stack([-unit, unit])[None]), "mm")
