"""Boards on their plate in the JSON document of ``labcal calibrate``, and for people."""

from dataclasses import dataclass

import numpy as np

from labcal.correspond.detections import Detections
from labcal.geometry.poses import rotation_vector
from labcal.targets.board_set import BoardSet


@dataclass(frozen=True)
class BoardResult:
    """A board on a plate of several."""

    name: str
    views: int
    """In which it entered, whichever camera saw it."""
    T_set_board: list[list[float]]
    """From the board's frame to that of the first board, mm."""
    sigma_rotation_rad: list[float] | None
    """Standard deviations of its rotation about the first board's axes; null where the place was stated."""
    sigma_mm: list[float] | None
    """Standard deviations of its origin along these axes; likewise."""


def board_results(boards: BoardSet, entering: Detections) -> list[BoardResult]:
    """Return the boards where a calibration found them.

    Parameters
    ----------
    boards : BoardSet
        With places.
    entering : Detections
        The dots that entered, numbered as those of the set.
    """
    number = boards.board_number[entering.index[:, 0]]
    return [
        BoardResult(
            name=board.name,
            views=len(set(entering.view[number == k].tolist())),
            T_set_board=[list(row) for row in place.T_set_board],
            sigma_rotation_rad=None if place.sigma_rotation_rad is None else list(place.sigma_rotation_rad),
            sigma_mm=None if place.sigma_mm is None else list(place.sigma_mm),
        )
        for k, (board, place) in enumerate(zip(boards.targets, boards.places or (), strict=True))
    ]


def board_lines(boards: list[BoardResult]) -> list[str]:
    """Return where boards are on their plate, for people."""
    first, lines = boards[0].name, [f"{boards[0].name}: the frame of the plate, in {boards[0].views} views"]
    for board in boards[1:]:
        T = np.array(board.T_set_board)
        turned = float(np.degrees(np.linalg.norm(rotation_vector(T))))
        shifts = zip(T[:3, 3].tolist(), board.sigma_mm or [0.0] * 3, strict=True)
        origin = ", ".join(f"{shift:.3f} ± {sigma:.3f}" for shift, sigma in shifts)
        sigma = float(np.degrees(np.linalg.norm(board.sigma_rotation_rad or [0.0])))
        lines.append(
            f"{board.name}: origin at x, y, z = {origin} mm from that of {first}, turned by {turned:.3f} ± "
            f"{sigma:.3f}°, in {board.views} views"
        )
    return lines
