"""The data of a row from pictures, with the exact cameras that saw its dots."""

from dataclasses import dataclass

import numpy as np

from labcal.arrays import Vectors3
from labcal.cameras.camera import Camera
from labcal.paper.problem import Problem
from labcal.paper.rows import SCENES, Data
from labcal.scene.catalogue import load_scene


@dataclass(frozen=True)
class BoardProblem:
    """Detected dots, and the geometry of their pictures.

    Attributes
    ----------
    problem : Problem
        Pixels of the detected dots, and their places, mm.
    cameras : tuple of Camera
        The cameras of the scene.
    world : ndarray, shape (n, 3)
        Places of the trained dots before these cameras, mm.
    """

    problem: Problem
    cameras: tuple[Camera, ...]
    world: Vectors3

    @property
    def lengths_mm(self) -> np.ndarray:
        """Extent of the trained dots along X and Y, mm."""
        return np.asarray(np.ptp(self.world[:, :2], axis=0))

    @property
    def pixel_mm(self) -> float:
        """Length on the board that a pixel sees: the mean over dots, cameras, X and Y."""
        seen = [
            np.linalg.norm(camera.project(self.world + step).q - camera.project(self.world).q, axis=1)
            for camera in self.cameras
            for step in np.eye(3)[:2]
        ]
        return float(1.0 / np.mean(seen))

    @property
    def camera_distance_mm(self) -> float:
        """Mean distance of the trained dots from the cameras."""
        distances = [np.linalg.norm(self.world - camera.centre, axis=1) for camera in self.cameras]
        return float(np.mean(distances))


def board_problem(data: Data, problem: Problem) -> BoardProblem:
    """Return the data of a row with the cameras of its scene.

    Parameters
    ----------
    data : Data
        A kind that comes from pictures.
    problem : Problem
    """
    scene = load_scene(SCENES[data])
    world = problem.Y[:, :3].copy()
    if data is Data.STILL_POSITIONS:  # Z stays with the target, which is lowered by the fourth output
        world[:, 2] -= problem.Y[:, 3]
    return BoardProblem(problem, tuple(camera.camera() for camera in scene.cameras.values()), world)
