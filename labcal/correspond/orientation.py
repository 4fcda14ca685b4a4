"""Orientation of plain grids, resolved over all pictures of a rig and of a series.

One picture does not determine the orientation of a grid that looks the same after half a turn (or a quarter).
The numberings of all cameras of a view must agree, though; and the target is assumed to rotate as little as
possible between views, so that a series is numbered alike. The whole series may still be rotated: that does
not matter for a hand-held target, and `PictureDots.others` holds the other numberings.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Pixels
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.geometry.epipolar import epipolar_misfit
from labcal.targets.target import Target

_ALIKE = 0.7  # mean resultant length of the turns between two cameras over the views, at least
_SURE_TURN = 1 / 3  # of the angle between two numberings: less is certainly the same orientation
_DECISIVE = 1 / 3  # of the other numberings' misfits: less is proof
_FEWEST_VIEWS = 2  # one view of a flat target fits any epipolar geometry


@dataclass(frozen=True)
class _Seen:
    """A picture with several possible numberings, and the rotation of the board for each, radians."""

    number: int
    dots: PictureDots
    turns: Float64[np.ndarray, " numberings"]

    def nearest(self, turn: float) -> int:
        """Return the numbering whose rotation is nearest to an angle."""
        return int(np.argmax(np.cos(self.turns - turn)))

    def numbered(self, numbering: int) -> PictureDots:
        """Return the dots under a numbering; 0 is that of the picture itself."""
        return self.dots if numbering == 0 else self.dots.renumbered(numbering - 1)

    def index(self, numbering: int) -> np.ndarray:
        """Return (col, row) under a numbering; 0 is that of the picture itself."""
        return self.dots.index if numbering == 0 else self.dots.others[numbering - 1]


def resolve_orientation(
    sources: Sequence[Source], pictures: Sequence[PictureDots], target: Target
) -> list[PictureDots]:
    """Return pictures with numberings that agree in every view and rotate little between views.

    Two cameras turned against each other about their axes by less than a third of what lies between two
    numberings (60 degrees, for a square grid 30) see the target in the same orientation. Else, or where that
    is contradicted, the numbering is taken under which all views together have an epipolar geometry, if all
    others fit it three times worse; this takes two views that are not parallel.

    Parameters
    ----------
    sources : sequence of Source
        Which view and camera each picture is of.
    pictures : sequence of PictureDots
        What was found in them.
    target : Target

    Returns
    -------
    list of PictureDots
        In the same order; pictures of a camera that cannot be resolved relative to the first one are refused
        as ``ambiguous``.
    """
    seen: dict[str, dict[str, _Seen]] = {}
    for number, (source, dots) in enumerate(zip(sources, pictures, strict=True)):
        if dots.indexed and dots.others and dots.ok.any():
            found = _Seen(number, dots, _turns(dots, target))
            seen.setdefault(source.camera, {})[source.view] = found
    resolved = list(pictures)
    rolls: dict[str, float] = {}
    for name, of_camera in seen.items():
        roll = _roll(seen[next(iter(seen))], of_camera)
        if roll is None:
            for found in of_camera.values():
                resolved[found.number] = found.dots.refused(Refusal.AMBIGUOUS)
        else:
            rolls[name] = roll
    turn = 0.0
    for view in dict.fromkeys(source.view for source in sources):
        together = [(seen[name][view], roll) for name, roll in rolls.items() if view in seen[name]]
        turn = _next_turn(together, turn)
        for found, roll in together:
            resolved[found.number] = found.numbered(found.nearest(turn + roll))
    return resolved


def _next_turn(together: list[tuple[_Seen, float]], turn: float) -> float:
    """Return the rotation of the target in a view that is nearest to the previous one."""
    if not together:
        return turn
    found, roll = together[0]
    return float(found.turns[found.nearest(turn + roll)]) - roll


def _turns(dots: PictureDots, target: Target) -> np.ndarray:
    """Return the rotation of the board in the picture under every numbering, radians."""
    from labcal.detect.lattice.plain import turn_in_picture  # noqa: PLC0415 -- imports Numba, which tables do not need

    return np.array(
        [
            turn_in_picture(target.points(index[dots.ok])[:, :2], dots.position[dots.ok])
            for index in (dots.index, *dots.others)
        ]
    )


def _roll(first: dict[str, _Seen], other: dict[str, _Seen]) -> float | None:
    """Return the relative roll of the other camera, or None if it cannot be resolved."""
    pairs = [(first[view], other[view]) for view in first if view in other]
    if not pairs:
        return 0.0  # in no view do they see it together, so there is nothing to agree on
    fold = len(pairs[0][0].turns)
    differences = np.array([b.turns[0] - a.turns[0] for a, b in pairs])
    mean = np.exp(1j * fold * differences).mean()
    if abs(mean) < _ALIKE:
        return None
    rolls = np.angle(mean) / fold + 2 * np.pi / fold * np.arange(fold)
    rolls = np.angle(np.exp(1j * rolls))
    upright = int(np.abs(rolls).argmin())
    if len(pairs) >= _FEWEST_VIEWS:
        misfits = np.array([epipolar_misfit(*_matched(pairs, roll)) for roll in rolls])
        best = int(misfits.argmin())
        if (np.delete(misfits, best) * _DECISIVE > misfits[best]).all():
            return float(rolls[best])
    sure = abs(rolls[upright]) < _SURE_TURN * 2 * np.pi / fold
    return float(rolls[upright]) if sure else None


def _matched(pairs: list[tuple[_Seen, _Seen]], roll: float) -> tuple[Pixels, Pixels]:
    """Return the dots that both cameras measured, px, with the second one rotated by `roll`."""
    in_first, in_other = [], []
    for a, b in pairs:
        index = b.index(b.nearest(float(a.turns[0]) + roll))
        places = {tuple(key): k for k, key in enumerate(index.tolist()) if b.dots.ok[k]}
        for k, key in enumerate(a.dots.index.tolist()):
            if a.dots.ok[k] and tuple(key) in places:
                in_first.append(a.dots.position[k])
                in_other.append(b.dots.position[places[tuple(key)]])
    return np.array(in_first).reshape(-1, 2), np.array(in_other).reshape(-1, 2)
