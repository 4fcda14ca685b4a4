"""Training data from a hand-held target that a bundle adjustment placed."""

from dataclasses import replace

import numpy as np

from labcal.calibrate.eccentricity import CorrectedEccentricity, Discs, eccentricities_at_poses
from labcal.calibrate.handheld_calibration import HandheldCalibration
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.estimators.centred_training import CentredTraining
from labcal.geometry.poses import transform
from labcal.targets.target import Target


def handheld_training(found: HandheldCalibration, detections: Detections, target: Target) -> CentredTraining:
    """Return the dots that all cameras measured, with their places in each view.

    Parameters
    ----------
    found : HandheldCalibration
        Of the same detections. Its world is that of the points: the first camera's frame.
    detections : Detections
        Centroids.
    target : Target
        Its dots are where it was declared to have them, or where the calibration found them.

    Raises
    ------
    InputError
        The calibration is of one camera, or no dot of its views was measured by all cameras.
    """
    cameras = [found.rig.camera(name) for name in found.rig.cameras]
    names = tuple(found.rig.cameras)
    if len(names) == 1:
        raise InputError(
            f"There are pictures of one camera only, '{names[0]}'. Points in space need two cameras or more."
        )
    matches = match(found.entering(detections), names)
    if len(matches) == 0:
        raise InputError(f"No dot was measured by all of the cameras {', '.join(names)} in the same view.")
    discs = Discs.of(target) if found.freed is None else Discs(found.freed.place, Discs.of(target).radii)
    dots = matches.index[:, 1] * target.cols + matches.index[:, 0]
    T_world_target = dict(zip(found.views, found.T_world_target, strict=True))
    p = np.empty((len(matches), 3))
    for view, T in T_world_target.items():
        rows = matches.view == view
        p[rows] = transform(T, discs.centres[dots[rows]])
    eccentricity = eccentricities_at_poses(cameras, matches.view, dots, T_world_target, discs)
    centred = replace(matches, q=matches.q - eccentricity)
    sizes = tuple(detections.picture_size(name) for name in names)
    data = TrainingData(names, sizes, centred.view, centred.index, centred.X, p)
    rig, corrected = found.rig, CorrectedEccentricity.of(eccentricity)
    record = _without_support(rig.calibration)
    return CentredTraining(data, tuple(cameras), corrected, None, record, rig.covariance)


def _without_support(record: CalibrationRecord | None) -> CalibrationRecord | None:
    """Return a record for a model, whose own box states the region that it was fitted in."""
    return None if record is None else record.model_copy(update={"support": None})
