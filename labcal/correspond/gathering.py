"""One table of the dots of many pictures, or of several tables."""

from collections.abc import Iterable, Sequence
from dataclasses import fields

import numpy as np

from labcal.correspond.detections import Detections
from labcal.correspond.sources import Source
from labcal.detect.dots import PictureDots


def gather(sources: Sequence[Source], pictures: Iterable[PictureDots]) -> Detections:
    """Return one table of what was found in each picture."""
    pairs = list(zip(sources, pictures, strict=True))
    counts = [len(dots.flag) for _, dots in pairs]
    sizes = np.array([dots.size for _, dots in pairs], dtype=np.int64).reshape(-1, 2)
    flags = [flag.value for _, dots in pairs for flag in dots.flag]
    return Detections(
        view=np.repeat(np.array([source.view for source in sources], dtype=np.str_), counts),
        camera=np.repeat(np.array([source.camera for source in sources], dtype=np.str_), counts),
        image=np.repeat(np.array([source.image for source in sources], dtype=np.str_), counts),
        size=np.repeat(sizes, counts, axis=0),
        index=np.concatenate([_own_index(dots) for _, dots in pairs]).astype(np.int64),
        has_id=np.concatenate([dots.has_id for _, dots in pairs]),
        position=np.concatenate([dots.position for _, dots in pairs]),
        covariance=np.concatenate([dots.covariance for _, dots in pairs]),
        flag=np.array(flags, dtype=np.str_),
        board=np.concatenate([_board(dots) for _, dots in pairs]),
    )


def _own_index(dots: PictureDots) -> np.ndarray:
    """Return (col, row) of dots on their own boards."""
    return dots.index if dots.own is None else np.where(dots.has_id[:, None], dots.own.index, 0)


def _board(dots: PictureDots) -> np.ndarray:
    """Return the names of the boards of dots; empty of one board, and of dots without an id."""
    return np.full(len(dots.flag), "") if dots.own is None else np.where(dots.has_id, dots.own.board, "")


def joined(tables: Sequence[Detections]) -> Detections:
    """Return one table with the lines of several."""
    columns = (column.name for column in fields(Detections))
    return Detections(*(np.concatenate([getattr(table, name) for table in tables]) for name in columns))
