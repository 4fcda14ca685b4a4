"""From a picture to the dots of several boards side by side."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from jaxtyping import Int64

from labcal.arrays import Mask
from labcal.detect.dots import OwnPlaces, PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.hidden_board import without_board
from labcal.detect.hidden_markers import without_other_markers
from labcal.detect.settings import DetectSettings
from labcal.targets.april_grid import AprilGrid
from labcal.targets.board_set import BoardSet
from labcal.targets.charuco import CharucoBoard
from labcal.targets.coded_dots import CodedDots
from labcal.targets.target import PrintableTarget
from labcal.wording import listed

_SAME_PLACE_PX = 2.0
"""Distance of dots of two boards below which both claim one."""
_CLAIMED = 3
"""Dots that two boards both claim from which on one is taken for the other."""


def detect_boards(grey: GreyPicture, boards: BoardSet, settings: DetectSettings) -> PictureDots:
    """Find the dots of all boards of a set in one picture.

    Boards that markers number are found first, each by the detector of its kind. Then those that are known
    by rings or by their columns and rows, in a picture in which the boards that are found already are hidden.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    boards : BoardSet
    settings : DetectSettings

    Returns
    -------
    PictureDots
        Dots numbered as those of the set, with their own places beside. Refused where no board is found, and
        where two boards claim the same dots.
    """
    found = _each(grey, boards, settings)
    merged = _merged(found, boards)
    if not any(one.indexed for one in found):
        first = next((one.refusal for one in found if one.refusal is not Refusal.NO_MARKERS), None)
        reasons = listed(
            [f"'{board.name}': {one.refusal}" for board, one in zip(boards.targets, found, strict=True)]
        )
        return merged.refused(first or Refusal.NO_MARKERS, f"No board was found ({reasons}).")
    if claimed := _claimed_twice(merged, boards):
        return merged.refused(
            Refusal.AMBIGUOUS, f"The boards {listed(claimed)} both fit dots at the same places."
        )
    return merged


def _each(grey: GreyPicture, boards: BoardSet, settings: DetectSettings) -> list[PictureDots]:
    """Return what is found of every board by itself."""
    from labcal.detect.detector import detect_dots  # noqa: PLC0415 -- it calls this detector

    found: dict[int, PictureDots] = {}
    numbered = [k for k, board in enumerate(boards.targets) if _has_codes(board)]
    plain = [k for k in range(len(boards.targets)) if k not in numbered]
    for number in numbered:
        charuco = isinstance(boards.targets[number], CharucoBoard)
        shown = without_other_markers(grey, boards, number, settings) if charuco else grey
        found[number] = detect_dots(shown, boards.targets[number], settings)
    left, rest = plain, grey
    for number in numbered if plain else []:
        rest = without_board(rest, found[number], boards.targets[number])
    while left:
        for number in left:
            found[number] = detect_dots(rest, boards.targets[number], settings)
            if found[number].indexed:
                rest = without_board(rest, found[number], boards.targets[number])
        missing = [number for number in left if not found[number].indexed]
        if len(missing) == len(left):
            break
        left = missing  # which another board, hidden by now, may have been taken for
    return [found[number] for number in range(len(boards.targets))]


def _has_codes(board: PrintableTarget) -> bool:
    """Tell whether ids are printed on a board."""
    return isinstance(board, CharucoBoard | AprilGrid | CodedDots)


def _merged(found: Sequence[PictureDots], boards: BoardSet) -> PictureDots:
    """Return the dots of all boards with the numbers of the set; what one is not sure of may be another's."""
    parts = [
        _numbered(dots, boards, number, _seen_by_others(dots, [*found[:number], *found[number + 1 :]]))
        for number, dots in enumerate(found)
    ]
    order = np.argsort(~np.concatenate([part.has_id for part in parts]), kind="stable")
    flags = [flag for part in parts for flag in part.flag]
    own = [part.own for part in parts if part.own is not None]
    return PictureDots(
        size=found[0].size,
        polarity=found[0].polarity,
        refusal=None,
        index=np.concatenate([part.index for part in parts])[order],
        has_id=np.concatenate([part.has_id for part in parts])[order],
        position=np.concatenate([part.position for part in parts])[order],
        covariance=np.concatenate([part.covariance for part in parts])[order],
        misfit=np.concatenate([part.misfit for part in parts])[order],
        flag=tuple(flags[k] for k in order),
        seen_at=np.concatenate([part.seen_at for part in parts])[order],
        outline=np.concatenate([part.outline for part in parts])[order],
        own=OwnPlaces(
            np.concatenate([one.board for one in own])[order],
            np.concatenate([one.index for one in own])[order],
        ),
    )


def _numbered(dots: PictureDots, boards: BoardSet, number: int, leave_out: Mask) -> PictureDots:
    """Return the dots of one board with their numbers in the set, without those of a mask."""
    board, first = boards.targets[number], boards.spans[number].start
    col, row = dots.index.T
    inside = dots.has_id & (col >= 0) & (row >= 0) & (col < board.cols) & (row < board.rows)
    flat = np.where(inside, first + row * board.cols + col, 0).astype(np.int64)
    kept = np.flatnonzero(~leave_out)
    name = np.where(inside, board.name, "")
    return replace(
        dots,
        index=np.stack([flat, np.zeros_like(flat)], axis=-1)[kept],
        has_id=inside[kept],
        position=dots.position[kept],
        covariance=dots.covariance[kept],
        misfit=dots.misfit[kept],
        flag=tuple(dots.flag[k] for k in kept),
        seen_at=dots.seen_at[kept],
        outline=dots.outline[kept],
        others=(),
        own=OwnPlaces(name[kept], np.where(inside[:, None], dots.index, 0)[kept]),
    )


def _seen_by_others(dots: PictureDots, others: Sequence[PictureDots]) -> Mask:
    """Return which dots without an id are within boards that are found, or unnamed there as well."""
    unnamed = ~dots.has_id
    if not dots.indexed and any(one.indexed for one in others):
        return np.ones(len(unnamed), dtype=bool)
    leave = np.zeros(len(unnamed), dtype=bool)
    for other in others:
        known = other.seen_at[other.has_id] if other.indexed else other.seen_at[:0]
        for k in np.flatnonzero(unnamed) if len(known) else ():
            leave[k] |= np.linalg.norm(known - dots.seen_at[k], axis=1).min() < _spacing(known)
    return leave


def _spacing(places: np.ndarray) -> float:
    """Return about how far dots of a board are apart in the picture, px."""
    extent = np.ptp(places, axis=0)
    return float(np.sqrt(max(float(extent[0] * extent[1]), 1.0) / len(places)))


def _claimed_twice(merged: PictureDots, boards: BoardSet) -> tuple[str, ...]:
    """Return the names of two boards that both have dots at the same places; nothing where none have."""
    ok = np.flatnonzero([flag is DotFlag.OK for flag in merged.flag])
    number: Int64[np.ndarray, " ok"] = boards.board_number[merged.index[ok, 0]]
    for one in range(len(boards.targets)):
        for other in range(one + 1, len(boards.targets)):
            a, b = merged.position[ok[number == one]], merged.position[ok[number == other]]
            near = np.linalg.norm(a[:, None] - b, axis=-1) < _SAME_PLACE_PX
            if near.sum() >= _CLAIMED:
                return boards.names[one], boards.names[other]
    return ()
