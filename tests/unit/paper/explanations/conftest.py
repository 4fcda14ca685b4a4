"""Exact pixels of the board of row 19, in place of detected ones."""

import numpy as np
import pytest

from labcal.paper.explanations.board_problem import BoardProblem, board_problem
from labcal.paper.problem import Problem
from labcal.paper.rows import SCENES, Data
from labcal.scene.catalogue import load_scene


@pytest.fixture(scope="session")
def board() -> BoardProblem:
    """The still cameras before a level board."""
    scene = load_scene(SCENES[Data.STILL_PLANE])
    dots = scene.target.points() + np.array([650.0, 650.0, 200.0])
    between = dots.reshape(10, 13, 3)[:-1, :-1].reshape(-1, 3) + np.array([29.0, 38.0, 0.0])
    X, X_test = (
        np.concatenate([camera.camera().project(p).q for camera in scene.cameras.values()], axis=1)
        for p in (dots, between)
    )
    return board_problem(Data.STILL_PLANE, Problem(X, dots, X_test, between))
