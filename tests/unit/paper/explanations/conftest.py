"""Exact pixels of the boards of rows 17 to 23, in place of detected ones."""

import numpy as np
import pytest

from labcal.paper.explanations.board_problem import BoardProblem, board_problem
from labcal.paper.problem import Problem
from labcal.paper.rows import SCENES, Data
from labcal.scene.catalogue import load_scene
from labcal.scene.views import planned_views
from labcal.shoot.manifest import Role


def exact_problem(data: Data) -> Problem:
    """Return the dots of the training views, and points between the dots of the first of them."""
    scene = load_scene(SCENES[data])
    origins = [v.T_world_target[:3, 3] for v in planned_views(scene, 0) if v.role is Role.TRAIN]
    dots = scene.target.points()
    between = dots.reshape(10, 13, 3)[:-1, :-1].reshape(-1, 3) + np.array([29.0, 38.0, 0.0])
    trained = np.concatenate([dots + origin for origin in origins])
    tested = between + origins[0]
    X, X_test = (
        np.concatenate([camera.camera().project(p).q for camera in scene.cameras.values()], axis=1)
        for p in (trained, tested)
    )
    if data is Data.STILL_POSITIONS:
        highest = max(origin[2] for origin in origins)
        trained, tested = (
            np.column_stack([p[:, :2], np.full(len(p), highest), highest - p[:, 2]])
            for p in (trained, tested)
        )
    return Problem(X, trained, X_test, tested)


@pytest.fixture(scope="session")
def board() -> BoardProblem:
    """The still cameras before a level board."""
    return board_problem(Data.STILL_PLANE, exact_problem(Data.STILL_PLANE))


@pytest.fixture(scope="session")
def problems() -> dict[Data, dict[str, Problem]]:
    """Every kind of pictures, as :func:`labcal.paper.pictured.pictured_problems` returns them."""
    return {data: {"": exact_problem(data)} for data in SCENES}
