"""Parts of a board whose dots are all alike, placed on it by another camera that sees it whole.

A part alone fits the board at many places. Its pose in its own camera is known up to a move within the
board's plane, though, and so is the camera's lens; under the right places the pose of one camera relative to
the other is the same in all views. Under places that are wrong alike in every view it is not, as soon as the
board is tilted differently from view to view.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels, Pose
from labcal.correspond.camera_poses import CameraPoses, camera_poses
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.geometry.poses import inverse, nearest_rotation, transform
from labcal.targets.target import Target

FEWEST_VIEWS = 3
"""Views of two cameras together that agree, at least: one part and one whole board always do."""
_DECISIVE = 1 / 3
"""Of what the next best places leave: less is proof."""
_LARGEST_RESIDUAL = 0.15
"""RMS of what right places leave in any view, in steps of the board, at most."""
_SAME_PLACE_MM = 1e-6
_STARTS = 2
"""Views from which relative poses are tried, those with the fewest numberings."""
_ROUNDS = 2
"""Of placing all views by the mean of their poses."""
UNPLACED = (
    "A part of the board is seen, and the other cameras' pictures do not settle which one. It takes "
    f"{FEWEST_VIEWS} views or more, tilted differently, in which another camera sees the whole board."
)


@dataclass(frozen=True)
class _Seen:
    """A picture of the second camera in a view in which the first one sees the board whole.

    Attributes
    ----------
    number : int
        Index of the picture.
    q : ndarray, shape (n, 2)
        Measured dots, px.
    places : ndarray, shape (numberings, n, 3)
        The dots on the board under every numbering, mm.
    T_first_board : ndarray, shape (4, 4)
        mm.
    T_second_board : tuple of ndarray, shape (4, 4)
        Under every numbering, mm.
    step : float
        Of the board in the picture, px.
    """

    number: int
    q: Pixels
    places: Float64[np.ndarray, "numberings n 3"]
    T_first_board: Pose
    T_second_board: tuple[Pose, ...]
    step: float

    def relative(self, numbering: int) -> Pose:
        """Return the second camera relative to the first one, mm."""
        T: Pose = self.T_second_board[numbering] @ inverse(self.T_first_board)
        return T

    def best(self, T_second_first: Pose) -> int:
        """Return the numbering whose pose in the second camera is nearest to that by the first one."""
        T, few = T_second_first @ self.T_first_board, self.places[:, self._spread]
        own = transform(self.T_second_board[0], few[0])
        off = few @ T[:3, :3].T + T[:3, 3] - own
        return int((off**2).sum(axis=(1, 2)).argmin())

    def moved(self, move: Pose, numbering: int) -> int | None:
        """Return the numbering of the dots after a move of the board; None where there is none."""
        few = self.places[:, self._spread]
        off: np.ndarray = np.abs(few - transform(move, few[numbering])).max(axis=(1, 2))
        nearest = int(off.argmin())
        return nearest if off[nearest] < _SAME_PLACE_MM else None

    @cached_property
    def _spread(self) -> np.ndarray:
        """Dots far from each other, which tell numberings apart."""
        places = self.places[0]
        first = int(np.linalg.norm(places - places.mean(axis=0), axis=1).argmax())
        second = int(np.linalg.norm(places - places[first], axis=1).argmax())
        along = places[second] - places[first]
        off = np.abs(np.cross(along, places - places[first])[:, 2])
        return np.array([first, second, int(off.argmax())])


def place_parts(
    sources: Sequence[Source], pictures: Sequence[PictureDots], target: Target
) -> list[PictureDots]:
    """Return pictures of which those that show a part have ids where another camera tells them.

    Parameters
    ----------
    sources : sequence of Source
        Which view and camera each picture is of.
    pictures : sequence of PictureDots
        Those with ids agree in each view.
    target : Target

    Returns
    -------
    list of PictureDots
        In the same order. A part is placed where the relative pose of two cameras agrees in at least three
        views, and every other way to place them leaves three times as much; it stays refused otherwise.
    """
    placed = list(pictures)
    parts = [k for k, dots in enumerate(pictures) if dots.refusal is not None and dots.part is not None]
    cameras = list(dict.fromkeys(source.camera for source in sources))
    if not parts or len(cameras) == 1:
        return placed
    poses = {
        name: camera_poses(
            {k: pictures[k] for k, source in enumerate(sources) if source.camera == name}, target
        )
        for name in cameras
    }
    for second in dict.fromkeys(sources[k].camera for k in parts):
        for first in cameras:
            if first == second or poses[first] is None or poses[second] is None:
                continue
            for number, numbering in _settled(sources, placed, (first, second), poses, target).items():
                part = placed[number].part
                if placed[number].refusal is not None and part is not None:
                    placed[number] = _numbered(part, numbering, target)
    for k in parts:
        if placed[k].refusal is not None:
            placed[k] = replace(placed[k], detail=f"{placed[k].detail} {UNPLACED}".strip())
    return placed


def _numbered(part: PictureDots, numbering: int, target: Target) -> PictureDots:
    """Return the dots of a part under a numbering, with those under the board's own symmetries."""
    dots = part if numbering == 0 else part.renumbered(numbering - 1)
    return replace(dots, others=target.symmetric_indices(dots.index))


def _settled(
    sources: Sequence[Source],
    pictures: Sequence[PictureDots],
    pair: tuple[str, str],
    poses: dict[str, CameraPoses | None],
    target: Target,
) -> dict[int, int]:
    """Return the numbering of each picture of the second camera; nothing where that is not certain."""
    seen = _seen_together(sources, pictures, pair, poses, target)
    second = poses[pair[1]]
    if len(seen) < FEWEST_VIEWS or second is None:
        return {}
    scores: dict[tuple[int, ...], float] = {}
    for start in sorted(seen, key=lambda one: len(one.places))[:_STARTS]:
        for numbering in range(len(start.places)):
            T = start.relative(numbering)
            for _ in range(_ROUNDS):
                chosen = tuple(one.best(T) for one in seen)
                T = _mean([one.relative(k) for one, k in zip(seen, chosen, strict=True)])
            if chosen not in scores:
                scores[chosen] = _residual(seen, chosen, T, second)
        if len(start.places) == 1:
            break  # its place is known, so no other one has to be tried
    ranked = sorted(scores, key=lambda chosen: scores[chosen])
    least = scores[ranked[0]]
    alone = _every_neighbour_is_worse(seen, ranked[0], least, second)
    decisive = all(least < _DECISIVE * scores[other] for other in ranked[1:])
    if least > _LARGEST_RESIDUAL or not (decisive and alone):
        return {}
    return {one.number: k for one, k in zip(seen, ranked[0], strict=True)}


def _every_neighbour_is_worse(
    seen: Sequence[_Seen], chosen: tuple[int, ...], least: float, second: CameraPoses
) -> bool:
    """Tell whether moving all parts alike on the board leaves three times as much, whatever the move."""
    if any(len(one.places) == 1 for one in seen):
        return True
    for numbering in range(len(seen[0].places)):
        move = _move(seen[0].places[chosen[0]], seen[0].places[numbering])
        other = [one.moved(move, k) for one, k in zip(seen, chosen, strict=True)]
        there = tuple(k for k in other if k is not None)
        if len(there) < len(seen) or there == chosen:
            continue
        T = _mean([one.relative(k) for one, k in zip(seen, there, strict=True)])
        if least >= _DECISIVE * _residual(seen, there, T, second):
            return False
    return True


def _seen_together(
    sources: Sequence[Source],
    pictures: Sequence[PictureDots],
    pair: tuple[str, str],
    poses: dict[str, CameraPoses | None],
    target: Target,
) -> list[_Seen]:
    """Return the second camera's pictures of views in which the first one sees the board whole."""
    first, second = poses[pair[0]], poses[pair[1]]
    whole = {
        source.view: k for k, source in enumerate(sources) if source.camera == pair[0] and pictures[k].indexed
    }
    found: list[_Seen] = []
    if first is None or second is None:
        return found
    for k, source in enumerate(sources):
        if source.camera != pair[1] or source.view not in whole or k not in second.T_camera_board:
            continue
        if whole[source.view] not in first.T_camera_board:
            continue
        dots = pictures[k] if pictures[k].indexed else pictures[k].part
        if dots is None:
            continue
        numberings = (dots.index,) if pictures[k].indexed else (dots.index, *dots.others)
        ok, own = dots.ok, second.T_camera_board[k]
        places = np.array([target.points(index[ok]) for index in numberings])
        board = tuple(own @ _move(there, places[0]) for there in places)
        q, T_first_board = dots.position[ok], first.T_camera_board[whole[source.view]]
        found.append(_Seen(k, q, places, T_first_board, board, _step(q)))
    return found


def _step(q: Pixels) -> float:
    """Return the usual distance from a dot to its nearest one, px."""
    apart = np.linalg.norm(q[:, None] - q, axis=-1)
    np.fill_diagonal(apart, np.inf)
    return float(np.median(apart.min(axis=1)))


def _move(there: Float64[np.ndarray, "n 3"], own: Float64[np.ndarray, "n 3"]) -> Pose:
    """Return the rigid move in the board's plane that takes places to their own ones."""
    a, b = there - there.mean(axis=0), own - own.mean(axis=0)
    angle = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a[:, :2] * b[:, :2]).sum())
    T = np.eye(4)
    T[:2, :2] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    T[:3, 3] = own.mean(axis=0) - T[:3, :3] @ there.mean(axis=0)
    return T


def _mean(poses: Sequence[Pose]) -> Pose:
    """Return the mean of poses: the rotation nearest to the mean matrix, and the mean translation."""
    mean: np.ndarray = np.mean(poses, axis=0)
    mean[:3, :3] = nearest_rotation(mean[:3, :3])[0]
    return mean


def _residual(
    seen: Sequence[_Seen], chosen: tuple[int, ...], T_second_first: Pose, second: CameraPoses
) -> float:
    """Return the RMS distance of dots from where the first camera puts them, of the worst view, in steps."""
    squares = []
    for one, k in zip(seen, chosen, strict=True):
        q = second.project(one.places[k], T_second_first @ one.T_first_board)
        squares.append(float(((q - one.q) ** 2).sum(axis=1).mean()) / one.step**2)
    return float(np.sqrt(max(squares)))
