"""The angle at a point between two others, with its uncertainty."""

import numpy as np

from labcal.errors import InputError
from labcal.reconstruct.chosen_lines import OnePoint
from labcal.reconstruct.chosen_points import AnyReconstruction, ChosenPoints
from labcal.reconstruct.measured import Measured

_STRAIGHT = 1e-9
"""Sine below which an angle is 0 or pi, where it has no first derivative."""


def angle(found: AnyReconstruction, corner: OnePoint, one: OnePoint, other: OnePoint) -> Measured:
    """Return the angle at a corner between the directions to two points of a rig, rad.

    Parameters
    ----------
    found : Reconstruction or NamedReconstruction
    corner, one, other : int, str or (str, str)
        Lines of the points in ``found.points``; of named points also their names, with the view before the
        name where several views have it: ``("loaded", "tip")``.

    Returns
    -------
    Measured
        Rad, 0 to pi; its sigma and the shares of noise and calibration in it.

    Raises
    ------
    InputError, InputTypeError
        There is no such line or name, one is given twice, the points lie on a line, one has no solution, or
        they are not those of a rig.

    Examples
    --------
    >>> import labcal
    >>> from labcal import examples, pipeline
    >>> found = pipeline.reconstruct(examples.rig(), examples.detections(), examples.TARGET)
    >>> labcal.angle(found, 0, 10, 11).unit  # in the corner of the board
    'rad'
    """
    points = ChosenPoints.single(found, (corner, one, other), ("corner", "one", "other"))
    a, b = points.point[1:] - points.point[0]
    normal = np.cross(a, b)
    sine, cosine = float(np.linalg.norm(normal)), float(a @ b)
    if sine <= _STRAIGHT * float(np.linalg.norm(a) * np.linalg.norm(b)):
        raise InputError("The points lie on a line: their angle has no first derivative. Give others.")
    axis = normal / sine
    # An end that moves across its arm, away from the other one, opens the angle by its way over the arm.
    by_one, by_other = np.cross(a, axis) / (a @ a), np.cross(axis, b) / (b @ b)
    slope = np.stack([-by_one - by_other, by_one, by_other])
    return Measured.of(float(np.arctan2(sine, cosine)), points.shares(slope[None]), "rad")
