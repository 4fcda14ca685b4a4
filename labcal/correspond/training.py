"""Training data: matched dots at the places of a stage."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Vectors3
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, require_on_target, stage_points
from labcal.errors import InputError
from labcal.shoot.dataset import Shoot
from labcal.shoot.manifest import Role
from labcal.targets.board_set import BoardSet


@dataclass(frozen=True)
class TrainingData:
    """Pixels and their points."""

    cameras: tuple[str, ...]
    image_sizes: tuple[tuple[int, int], ...]
    """Width and height of each camera's pictures, px."""
    view: np.ndarray
    """(n,) of str"""
    index: Int64[np.ndarray, "n 2"]
    """(col, row) of the dots."""
    X: Float64[np.ndarray, "n columns"]
    """Columns x1 y1 x2 y2 ..., px."""
    Y: Vectors3
    """(n, 3), stage world, mm."""


def training_data(shoot: Shoot, detections: Detections) -> TrainingData:
    """Return the dots of the training views that all cameras measured.

    Raises
    ------
    InputError
        The target was hand-held, it looks the same when it is turned, a dot is not on it, or no dot of a
        training view was measured by all cameras.
    """
    poses = shoot.nominal_poses()
    trained = [view.name for view in shoot.views(Role.TRAIN) if view.name in poses]
    if not trained:
        raise InputError(
            f"The target in {shoot.folder} was hand-held: no training view gives its pose, so there is "
            "nothing to fit to. Use 'labcal calibrate', or shoot the target on a stage."
        )
    if shoot.target.symmetric_indices(shoot.target.indices()[:1]):
        raise InputError(
            f"The target '{shoot.target.name}' looks the same when it is turned, so nothing determines which "
            "of its dots is where on the stage. Use one with rings, or hold it and use 'labcal calibrate'."
        )
    if isinstance(shoot.target, BoardSet) and shoot.target.places is None:
        raise InputError(
            "On a stage the places of boards on their plate must be known, and those of "
            f"'{shoot.target.name}' are not stated. Calibrate the cameras from views of the "
            "plate in the hand, and copy `places` from the rig into the description of the plate; or fit to "
            "one of the boards by itself."
        )
    require_on_target(detections, shoot.target)
    matches = match(detections, shoot.cameras)
    matches = matches.where(np.isin(matches.view, trained))
    if len(matches) == 0:
        raise InputError(
            "No dot of a training view was measured by all cameras; see the flags in the detections."
        )
    return TrainingData(
        cameras=shoot.cameras,
        image_sizes=tuple(detections.picture_size(name) for name in shoot.cameras),
        view=matches.view,
        index=matches.index,
        X=matches.X,
        Y=stage_points(matches, shoot.target, poses),
    )
