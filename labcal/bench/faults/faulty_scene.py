"""A scene of the rendered laboratory with a fault, for those that only pictures show and for comparison."""

import numpy as np

from labcal.bench.faults.registry import Fault
from labcal.errors import InputError
from labcal.scene.board import Board
from labcal.scene.mistakes import PITCH_FACTOR, Mistake
from labcal.scene.model import Scene
from labcal.targets.grid import DotGrid

_NOT_RENDERED = frozenset({"stage"})


def require_rendered(fault: Fault) -> None:
    """Raise unless the laboratory can make a fault.

    Raises
    ------
    InputError
        It cannot.
    """
    if fault.kind.name in _NOT_RENDERED:
        raise InputError(f"The laboratory cannot make the fault '{fault.kind.name}': its stage is exact.")


def faulty_scene(scene: Scene, fault: Fault) -> Scene:
    """Return a scene as it is with a fault; what methods know of it stays the same.

    The fault acts on every view of the scene, those to measure on included.

    Raises
    ------
    InputError
        The laboratory has no such fault, or the scene has a mistake already.
    """
    if scene.mistake is not None:
        raise InputError(
            f"The scene '{scene.name}' has the mistake '{scene.mistake}' already; set it to none."
        )
    require_rendered(fault)
    kind = fault.kind.name
    if kind in set(Mistake):
        return scene.model_copy(
            update={"mistake": Mistake(kind), "mistake_size": fault.size if fault.kind.has_size else None}
        )
    if kind == "pitch":
        size = fault.size / (PITCH_FACTOR - 1.0)
        return scene.model_copy(update={"mistake": Mistake.WRONG_PITCH, "mistake_size": size})
    if kind == "bend":
        return _with_board(scene, {"bend": {"along_x_mm": fault.size * _board_over_dots(scene.grid)}})
    return _with_board(scene, {"misplacement_mm": fault.size})


def _with_board(scene: Scene, defect: dict[str, object]) -> Scene:
    """Return a scene with a defect of its board."""
    return scene.model_copy(update={"board": Board.model_validate({**scene.board.model_dump(), **defect})})


def _board_over_dots(target: DotGrid) -> float:
    """Return the rise of a bend at the edge of the board over that at the outermost dots."""
    left, _, right, _ = target.extent_mm
    return float(((right - left) / np.ptp(target.points()[:, 0])) ** 2)
