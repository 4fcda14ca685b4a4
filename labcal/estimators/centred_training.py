"""Training data at images of dot centres: the eccentricity is corrected with resected cameras."""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from labcal.arrays import Pixels, Pose, Vectors3
from labcal.calibrate.agreement.exchange.by_places import refuse_exchanged_by_places
from labcal.calibrate.eccentricity import ROUNDS, CorrectedEccentricity, Discs, eccentricities_at_poses
from labcal.calibrate.resection.lens_choice import camera_of_lens, chosen_camera
from labcal.calibrate.resection.resected import ResectedCamera, resect
from labcal.calibrate.triangulation_check import calibration_record
from labcal.calibrate.triangulation_residuals import MOST_PX
from labcal.cameras.calibration_record import CalibrationRecord
from labcal.cameras.camera import Camera
from labcal.cameras.rig_covariance import RigCovariance
from labcal.correspond.matching import Matches
from labcal.correspond.training import TrainingData
from labcal.errors import InputError
from labcal.estimators.gp_field.stage_moves import StageMoves
from labcal.estimators.stage_errors import StageErrors
from labcal.geometry.arrangement import on_one_plane
from labcal.targets.target import Target

_NAME = "resection"
_NO_NOISE = 1e-12 * np.eye(2)
"""Covariance of training pixels, which is not known: all of the triangulation residual counts as scatter."""
_ON_ONE_PLANE = (
    "all training dots are on one plane, which determines no camera; the method fits the eccentricity, too"
)


@dataclass(frozen=True)
class CentredTraining:
    """Training data, and the correction that was applied."""

    data: TrainingData
    cameras: tuple[Camera, ...] | None
    """Resected from the training views; None where nothing was corrected."""
    eccentricity: CorrectedEccentricity | None
    """The corrected eccentricity."""
    reason: str | None
    """The reason why it was not corrected."""
    calibration: CalibrationRecord | None = None
    """The triangulation residual of the cameras on the training data."""
    covariance: RigCovariance | None = None
    """Joint covariance of the cameras, where they placed a target held in the hand."""
    stage: StageErrors | None = None
    """Errors of the cameras by those of a stage, where these are stated."""
    moves: StageMoves | None = None
    """Motions of the training points by these."""


def centred_training(
    data: TrainingData, target: Target, T_world_target: Mapping[str, Pose]
) -> CentredTraining:
    """Subtract the eccentricity from training pixels, with cameras resected from the training views.

    A method maps pixels of dots' centres to points. Where the views fill a volume, each camera is resected,
    and the eccentricity follows from the poses of the target. Views of a single plane determine no camera,
    but need none: there the eccentricity depends on nothing but the pixel, so the method fits it, too.

    Parameters
    ----------
    data : TrainingData
        Centroids.
    target : Target
    T_world_target : mapping of str to ndarray of shape (4, 4)
        Pose of the target by view, mm.

    Raises
    ------
    InputError
        The pictures of a view are exchanged.
    """
    if on_one_plane(data.Y):
        return CentredTraining(data, None, None, _ON_ONE_PLANE)
    q = data.X.reshape(len(data.X), -1, 2)
    discs, dots = Discs.of(target), data.index[:, 1] * target.cols + data.index[:, 0]
    eccentricity = np.zeros_like(q)
    cameras: list[ResectedCamera] = []
    for _ in range(ROUNDS):
        try:
            cameras = [
                _resected(q[:, number] - eccentricity[:, number], data.Y, size, cameras[number : number + 1])
                for number, size in enumerate(data.image_sizes)
            ]
        except InputError as error:
            refuse_exchanged_by_places(data)
            return CentredTraining(data, None, None, str(error))
        eccentricity = eccentricities_at_poses(
            [one.camera for one in cameras], data.view, dots, T_world_target, discs
        )
    if max(one.sigma_px for one in cameras) > MOST_PX:
        refuse_exchanged_by_places(data)
    centred = replace(data, X=(q - eccentricity).reshape(data.X.shape))
    found = tuple(one.camera for one in cameras)
    exact = np.tile(_NO_NOISE, (*q.shape[:2], 1, 1))
    matches = Matches(data.cameras, data.view, data.index, q - eccentricity, exact)
    return CentredTraining(
        centred, found, CorrectedEccentricity.of(eccentricity), None, calibration_record(found, matches)
    )


def _resected(q: Pixels, p: Vectors3, size: tuple[int, int], before: list[ResectedCamera]) -> ResectedCamera:
    """Return the camera resected from points (mm) and pixels, with the lens model of the previous round."""
    if not before:
        return chosen_camera(_NAME, q, p, size)
    return resect(_NAME, q, p, camera_of_lens(before[0].camera.lens, size, None))
