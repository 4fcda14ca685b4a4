"""Reconstructed points seen again by the cameras of their rig, against the measured dots."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels
from labcal.calibrate.eccentricity import centred
from labcal.cameras.rig import Rig
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.correspond.points import Points
from labcal.errors import InputError
from labcal.targets.target import Target


@dataclass(frozen=True)
class Reprojected:
    """Residuals of one camera.

    Attributes
    ----------
    camera : str
    size : (int, int)
        Width and height of its pictures, px.
    q : float64 array, (n, 2)
        Measured images of the dots' centres, px.
    residual : float64 array, (n, 2)
        Predicted minus measured, px.
    """

    camera: str
    size: tuple[int, int]
    q: Pixels
    residual: Float64[np.ndarray, "n 2"]


def reprojected(rig: Rig, points: Points, detections: Detections, target: Target) -> list[Reprojected]:
    """Return by how far the images of points miss the dots that they come from, by camera.

    Parameters
    ----------
    rig : Rig
        What the points were reconstructed with, in whose world they are.
    points : Points
    detections : Detections
        Centroids; those of other dots are left out.
    target : Target

    Returns
    -------
    list of Reprojected
        Empty where the dots are not of this rig.
    """
    names = tuple(rig.cameras)
    cameras = [rig.camera(name) for name in names]
    try:
        matches, _ = centred(cameras, match(detections, names), target)
    except InputError:
        return []
    keys = zip(points.view.tolist(), *points.index.T.tolist(), strict=True)
    lines = {key: line for line, key in enumerate(keys)}
    measured = zip(matches.view.tolist(), *matches.index.T.tolist(), strict=True)
    pairs = [(row, lines[key]) for row, key in enumerate(measured) if key in lines]
    if not pairs:
        return []
    rows, of_points = np.array(pairs).T
    found = []
    for number, (name, camera) in enumerate(zip(names, cameras, strict=True)):
        q = matches.q[rows, number]
        found.append(Reprojected(name, camera.size, q, camera.project(points.point[of_points]).q - q))
    return found
