"""Motions of boards on their plate as free directions of an adjustment, and what it finds of them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Vectors3
from labcal.calibrate.adjustment.observations import Observations
from labcal.calibrate.adjustment.rounds import Adjusted, adjust_in_rounds
from labcal.calibrate.adjustment.state import POSE, Freedom, Lenses, RigState
from labcal.calibrate.eccentricity import DiscShapes
from labcal.geometry.cross_matrices import cross_matrices
from labcal.geometry.poses import rigid_alignment
from labcal.targets.board_set import BoardSet

_MOST_ROUNDS = 6
_SETTLED_MM = 1e-5
"""Change of a dot's place by a round below which the boards count as rigid."""


@dataclass(frozen=True)
class BoardMotion:
    """Free rigid motions of all boards but the first.

    Attributes
    ----------
    basis : ndarray, shape (3 dots, free)
        Orthonormal, six columns a board.
    root : tuple of ndarray of shape (6, 6)
        Of each such board: its motion (rotation vector about the middle of its dots, shift) by the
        coordinates in the basis.
    """

    basis: Float64[np.ndarray, "coordinates free"]
    root: tuple[Float64[np.ndarray, "6 6"], ...]

    @classmethod
    def at(cls, dots: Vectors3, boards: BoardSet) -> "BoardMotion":
        """Return the motions of boards whose dots are at these places, mm."""
        columns, roots = [], []
        for span in boards.spans[1:]:
            mine = dots[span]
            motions = np.zeros((len(dots), 3, POSE))
            motions[span, :, :3] = -cross_matrices(mine - mine.mean(axis=0))
            motions[span, :, 3:] = np.eye(3)
            basis, R = np.linalg.qr(motions.reshape(dots.size, POSE))
            columns.append(basis)
            roots.append(np.linalg.inv(R))
        return cls(np.concatenate(columns, axis=1), tuple(roots))

    def pose_covariances(
        self, adjusted: Adjusted, dots: Vectors3, boards: BoardSet
    ) -> Float64[np.ndarray, "boards 6 6"]:
        """Return the covariance of each board's pose by the dots' noise: rotation (rad), then origin (mm).

        Both about the axes of the first board, whose own is 0; NaN where the views leave it open.
        """
        found = np.zeros((len(boards.targets), POSE, POSE))
        at = adjusted.layout.dots
        covariance = adjusted.covariance[at, at]
        for number, root in enumerate(self.root, start=1):
            mine = slice(POSE * (number - 1), POSE * number)
            of_motion = root @ covariance[mine, mine] @ root.T
            arm = boards.poses[number][:3, 3] - dots[boards.spans[number]].mean(axis=0)
            by_motion = np.eye(POSE)
            by_motion[3:, :3] = -cross_matrices(arm[None])[0]
            found[number] = by_motion @ of_motion @ by_motion.T
        return found


@dataclass(frozen=True)
class BoardsAdjusted:
    """An adjustment with the poses of boards on their plate among the unknowns."""

    adjusted: Adjusted
    boards: BoardSet
    """The boards where they were found."""
    covariance: Float64[np.ndarray, "boards 6 6"]
    """Of each pose: rotation vector about the first board's axes (rad), then the origin (mm)."""


def adjust_boards(
    start: RigState, observations: Observations, boards: BoardSet, lenses: Lenses, eccentricity_rounds: int
) -> BoardsAdjusted:
    """Adjust cameras, poses of the plate and, unless they are stated, poses of boards on it.

    A step moves dots along straight lines; after each adjustment every board is made rigid again at the
    nearest place, and the adjustment repeated until nothing changes.

    Parameters
    ----------
    start : RigState
        Near enough; its dots are the boards' at `boards.poses`.
    observations : Observations
    boards : BoardSet
        With places: those known, which are kept, or first values.
    lenses : Lenses
    eccentricity_rounds : int
        As of :func:`~labcal.calibrate.adjustment.rounds.adjust_in_rounds`.

    Raises
    ------
    InputError
        As of that function.
    """
    state = start
    for _ in range(_MOST_ROUNDS):
        motion = BoardMotion.at(state.dots, boards)
        adjusted = adjust_in_rounds(
            state, observations, Freedom(lenses, motion.basis), DiscShapes.of(boards), eccentricity_rounds
        )
        boards = rigid_again(adjusted.state.dots, boards)
        places = boards.points()
        moved = float(np.abs(places - state.dots).max())
        state = RigState(adjusted.state.cameras, adjusted.state.T_world_target, places)
        if moved < _SETTLED_MM:
            break
    covariance = motion.pose_covariances(adjusted, state.dots, boards)
    return BoardsAdjusted(adjusted, boards, covariance)


def adjust_known_boards(
    start: RigState, observations: Observations, boards: BoardSet, lenses: Lenses, eccentricity_rounds: int
) -> BoardsAdjusted:
    """Adjust as :func:`adjust_boards` does with the boards where they are stated."""
    freedom = Freedom(lenses, np.zeros((3 * boards.count, 0)))
    adjusted = adjust_in_rounds(start, observations, freedom, DiscShapes.of(boards), eccentricity_rounds)
    return BoardsAdjusted(adjusted, boards, np.zeros((len(boards.targets), POSE, POSE)))


def rigid_again(dots: Vectors3, boards: BoardSet) -> BoardSet:
    """Return the boards at the rigid places nearest to where their dots are, mm."""
    poses = [np.eye(4)]
    for board, span in zip(boards.targets[1:], boards.spans[1:], strict=True):
        poses.append(rigid_alignment(dots[span], board.points()))
    return boards.placed(np.stack(poses))
