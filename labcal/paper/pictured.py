"""The data of rows 17 to 23: dots detected in rendered pictures instead of the hardware of the paper."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

from labcal.arrays import Vectors3
from labcal.correspond.detections import Detections
from labcal.correspond.matching import match, stage_points
from labcal.correspond.training import TrainingData, training_data
from labcal.geometry.hull import inside_hull
from labcal.paper.problem import Problem
from labcal.paper.rows import Data
from labcal.render.shoot import RenderSettings, render_shoot
from labcal.run.made import make_folder
from labcal.run.progress import Progress
from labcal.scene.catalogue import load_scene
from labcal.shoot.dataset import Shoot, is_shoot, open_shoot
from labcal.shoot.manifest import Role
from labcal.shoot.truth import read_truth

_TOLERANCE_MM = 1e-3
AT_POSITIONS = "at the trained positions"
BETWEEN_POSITIONS = "half-way between the trained positions"


def kept_shoot(folder: Path, scene: str, settings: RenderSettings, progress: Progress) -> Shoot:
    """Render a shoot of a shipped scene, unless an earlier run has.

    Raises
    ------
    OutputError, DeviceError
        As of :func:`labcal.render.shoot.render_shoot`.
    """
    if is_shoot(folder):
        return open_shoot(folder)
    make_folder(folder.parent)
    return render_shoot(load_scene(scene), folder, settings, progress)


@dataclass(frozen=True)
class _Tested:
    """Matched dots of the test views, and their true positions."""

    view: np.ndarray
    X: np.ndarray
    Y: Vectors3


def pictured_problems(data: Data, shoot: Shoot, detections: Detections) -> dict[str, Problem]:
    """Return training and test data of a row from pictures, by the name of the reading.

    Test dots are those of the test views within the hull of the trained dots; the truth is their place.

    Parameters
    ----------
    data : Data
        Which kind of row.
    shoot : Shoot
        Rendered; its folder holds the truth.
    detections : Detections
        The dots found in its pictures.

    Raises
    ------
    InputError
        No dot of a training view was measured by all cameras.
    """
    trained = training_data(shoot, detections)
    tested = _tested(shoot, detections)
    if data is Data.STILL_POSITIONS:
        return _position_problems(shoot, trained, tested)
    inside = inside_hull(tested.Y, trained.Y, _TOLERANCE_MM)
    return {"": Problem(trained.X, trained.Y, tested.X[inside], tested.Y[inside])}


def _tested(shoot: Shoot, detections: Detections) -> _Tested:
    matches = match(detections, shoot.cameras)
    matches = matches.where(np.isin(matches.view, [view.name for view in shoot.views(Role.TEST)]))
    poses = {name: np.array(view.T_world_target) for name, view in read_truth(shoot.folder).views.items()}
    return _Tested(matches.view, matches.X, stage_points(matches, shoot.target, poses))


def _position_problems(shoot: Shoot, trained: TrainingData, tested: _Tested) -> dict[str, Problem]:
    """Return row 23: every fifth dot at each of five positions, with the camera distance as fourth output.

    Cameras that are raised by s see what they would see if the target were lowered by s, which is what the
    stage does. Points count in the frame that stays with the target, so the stage's way down is s.
    """
    stage_mm = {view: T[2, 3] for view, T in shoot.nominal_poses().items()}
    positions = [view.name for view in shoot.views(Role.TRAIN)]
    reference = max(stage_mm[name] for name in positions)
    turn = np.array([positions.index(view) for view in trained.view.tolist()])
    nth = np.concatenate([np.arange(count) for count in np.unique(turn, return_counts=True)[1]])
    chosen = nth % len(positions) == turn
    Y = _with_distance(trained.Y, trained.view, stage_mm, reference)
    Y_test = _with_distance(tested.Y, tested.view, stage_mm, reference)
    inside = inside_hull(Y_test[:, :3], Y[chosen, :3], _TOLERANCE_MM)
    at_position = np.isin(Y_test[:, 3], np.unique(Y[:, 3]))
    return {
        name: Problem(trained.X[chosen], Y[chosen], tested.X[wanted], Y_test[wanted])
        for name, wanted in {
            AT_POSITIONS: inside & at_position,
            BETWEEN_POSITIONS: inside & ~at_position,
        }.items()
    }


def _with_distance(p: Vectors3, view: np.ndarray, stage_mm: dict[str, float], reference: float) -> np.ndarray:
    """Return points in the frame of the target, and the distance of the cameras from the reference, mm."""
    distance = np.array([reference - stage_mm[name] for name in view.tolist()])
    return np.column_stack([p[:, :2], p[:, 2] + distance, distance])
