"""Distances of dots from the epipolar curves that cameras predict."""

import numpy as np

from labcal.arguments import object_of
from labcal.calibrate.eccentricity import centred
from labcal.cameras.rig import Rig
from labcal.cameras.triangulation import epipolar_distances
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.targets.catalogue import AnyTarget


def epipolar_rms(rig: Rig, detections: Detections, target: AnyTarget | None = None) -> float:
    """Return the RMS distance of dots from the first camera's epipolar curves, px; NaN for one camera.

    Parameters
    ----------
    rig : Rig
    detections : Detections
        Centroids.
    target : AnyTarget, optional
        What the dots are of; where it is given, the eccentricity of centroids is corrected first.

    Returns
    -------
    float
        Px, over the dots that the first camera and another one measured in the same view.

    Raises
    ------
    InputTypeError
        There is no rig, or there are no detections.
    InputError
        A dot is listed twice for a picture, is flagged ``ok`` without a position, or is not on the target.

    Examples
    --------
    >>> from labcal import examples, load_target, pipeline
    >>> target = load_target(examples.TARGET)
    >>> round(pipeline.epipolar_rms(examples.rig(), examples.detections(), target), 3)
    0.027
    """
    rig, detections = object_of(rig, Rig, "rig"), object_of(detections, Detections, "detections")
    first, *others = rig.cameras
    distances = [np.empty(0)]
    for other in others:
        pair = (rig.camera(first), rig.camera(other))
        matches = match(detections, (first, other))
        if target is not None:
            matches, _ = centred(pair, matches, target)
        distances.append(epipolar_distances(*pair, matches.q[:, 0], matches.q[:, 1]))
    all_distances = np.concatenate(distances)
    known = all_distances[np.isfinite(all_distances)]
    return float(np.sqrt((known**2).mean())) if len(known) else float("nan")
