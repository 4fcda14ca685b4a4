"""Points that are some: what a model or a rig gives beyond the bounds of sense is no solution."""

from typing import TYPE_CHECKING

import numpy as np

from labcal.arrays import PointCovariances, Vectors3
from labcal.bounds import MOST_MM
from labcal.cameras.calibration_share import calibration_share
from labcal.correspond.matching import Matches
from labcal.correspond.points import PointFlag, Points
from labcal.errors import InputError, LabcalError
from labcal.geometry.covariances import valid_or_not_stated

if TYPE_CHECKING:
    from labcal.estimators.model import Model


def predicted(model: "Model", matches: Matches) -> tuple[Vectors3, PointCovariances]:
    """Return the points of a method that was read from a file, mm, and their covariances, mm squared.

    A target that was held in the hand lay where the adjustment of its pictures placed it, which is in error
    as the cameras of that adjustment are: a method learns places that are off. The covariances hold it,
    and the errors of a stage where these are stated.

    Raises
    ------
    InputError
        Its numbers are such that nothing can be computed with them.
    """
    estimator, placed_by = model.estimator, model.placed_by
    try:
        with np.errstate(all="ignore"):
            outputs, covariance = estimator.predict_with_covariance(matches.X, matches.covariance)
            point = np.ascontiguousarray(outputs[:, :3])
            if model.stage is not None and model.resected is not None:
                return point, covariance + model.stage.share(model.resected, point, matches.covariance)
            if placed_by is None or placed_by.covariance is None:
                return point, covariance
            cameras = [placed_by.camera(name) for name in placed_by.cameras]
            share = calibration_share(cameras, placed_by.covariance.matrix, point, matches.covariance)
            return point, covariance + share
    except LabcalError:
        raise
    except (ValueError, ArithmeticError, RuntimeError) as error:  # LinAlgError is a ValueError
        raise InputError(
            f"The model of the method '{estimator.method}' gives no points ({error}): its numbers are "
            "damaged. Fit it again."
        ) from error


def within_sense(points: Points) -> Points:
    """Return points of which those that are nowhere (:data:`labcal.bounds.MOST_MM`) have no solution."""
    with np.errstate(invalid="ignore"):
        there = (np.abs(points.point) <= MOST_MM).all(axis=1)
    sound = there & valid_or_not_stated(points.covariance, MOST_MM**2)
    if sound.all():
        return points
    return Points(
        points.view,
        points.index,
        np.where(there[:, None], points.point, np.nan),
        np.where(sound[:, None, None], points.covariance, np.nan),
        np.where(there, points.flag, PointFlag.NO_SOLUTION.value),
        points.board,
    )
