"""Mistakes of an experimenter, each with a size: pictures of the board, or its measured places, are wrong."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from labcal.arguments import one_named
from labcal.paper.explanations.board_problem import BoardProblem
from labcal.paper.problem import Problem


@dataclass(frozen=True)
class Cause:
    """One kind of mistake.

    Attributes
    ----------
    name, words, unit : str
    likely : tuple of float
        The sizes that a careful to a careless experimenter would have.
    sizes : tuple of float
        Sizes that are tried in this order; between two of them the size is solved for.
    disturbed : callable
        Returns the data with a mistake of a size. Random numbers are drawn in the same order whatever the
        size, so that errors depend smoothly on it.
    """

    name: str
    words: str
    unit: str
    likely: tuple[float, float]
    sizes: tuple[float, ...]
    disturbed: Callable[[BoardProblem, float, np.random.Generator], Problem]


def _picked_by_hand(board: BoardProblem, size_px: float, random: np.random.Generator) -> Problem:
    """Return pixels with Gaussian noise, trained and tested alike."""
    problem = board.problem
    noise, test_noise = (random.standard_normal(values.shape) for values in (problem.X, problem.X_test))
    return replace(problem, X=problem.X + size_px * noise, X_test=problem.X_test + size_px * test_noise)


def _measured_by_ruler(board: BoardProblem, size_mm: float, random: np.random.Generator) -> Problem:
    """Return places with independent noise along the board: what is trained, and what is compared with."""
    problem = board.problem
    noise, test_noise = (random.standard_normal((len(Y), 2)) for Y in (problem.Y, problem.Y_test))
    Y, Y_test = problem.Y.copy(), problem.Y_test.copy()
    Y[:, :2] += size_mm * noise
    Y_test[:, :2] += size_mm * test_noise
    return replace(problem, Y=Y, Y_test=Y_test)


def _scaled_by_ruler(board: BoardProblem, size_mm: float, random: np.random.Generator) -> Problem:
    """Return trained places whose pitch is wrong, so that the length of the board is by this size."""
    del random
    Y = board.problem.Y.copy()
    first = Y[:, :2].min(axis=0)
    Y[:, :2] = first + (1.0 + size_mm / board.lengths_mm.max()) * (Y[:, :2] - first)
    return replace(board.problem, Y=Y)


def _bent(board: BoardProblem, size_mm: float, random: np.random.Generator) -> Problem:
    """Return the pixels of a board that is bent while trained: a paraboloid with its corners raised.

    The detected dots are moved by as much as the exact cameras see them move.
    """
    del random
    x, y = 2.0 * (board.world[:, :2] - board.world[:, :2].min(axis=0)).T / board.lengths_mm[:, None] - 1.0
    raised = board.world.copy()
    raised[:, 2] += size_mm * (x**2 + y**2) / 2.0
    moved = [camera.project(raised).q - camera.project(board.world).q for camera in board.cameras]
    return replace(board.problem, X=board.problem.X + np.concatenate(moved, axis=1))


def _displaced(board: BoardProblem, size_mm: float, random: np.random.Generator) -> Problem:
    """Return tested places that are wrong by the same amount in X, Y and Z."""
    del random
    Y_test = board.problem.Y_test.copy()
    Y_test[:, :3] += size_mm
    return replace(board.problem, Y_test=Y_test)


CAUSES: tuple[Cause, ...] = (
    Cause(
        "points picked by hand", "Gaussian noise of each image coordinate, trained and tested",
        "px", (1.0, 10.0), (0.1, 1.0, 10.0, 100.0), _picked_by_hand,
    ),
    Cause(
        "places by ruler, independent", "Gaussian noise of each place along the board, trained and tested",
        "mm", (0.5, 5.0), (0.1, 1.0, 10.0, 100.0), _measured_by_ruler,
    ),
    Cause(
        "places by ruler, scale", "a pitch that is wrong by this much over the length of the trained board",
        "mm", (0.5, 5.0), (0.1, 1.0, 10.0, 100.0), _scaled_by_ruler,
    ),
    Cause(
        "bent board", "corners raised over the middle while trained, taken for flat, tested flat",
        "mm", (0.5, 10.0), (0.1, 1.0, 10.0, 100.0), _bent,
    ),
    Cause(
        "displaced origin", "tested places that are all wrong by this much in X, Y and Z",
        "mm", (0.5, 10.0), (0.1, 1.0, 10.0, 100.0, 1000.0), _displaced,
    ),
)  # fmt: skip


def cause_named(name: str) -> Cause:
    """Return a cause.

    Raises
    ------
    UnknownNameError
        There is none of that name.
    """
    return one_named({cause.name: cause for cause in CAUSES}, "cause", name)
