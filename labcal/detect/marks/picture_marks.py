"""Result of the search for marks in one picture: named pixels with covariance, and what is not measured."""

from dataclasses import dataclass
from enum import StrEnum

import numpy as np

from labcal.arrays import Mask, PixelCovariances, Pixels


class MarkFlag(StrEnum):
    """Flag of one mark; only ``ok`` marks are measurements."""

    OK = "ok"
    """Named and measured."""
    BAD_FIT = "bad-fit"
    """Named, but the outline of its dot, or an edge at a corner, is not clean (hidden in part, smeared)."""
    BLURRED = "blurred"
    """Named, but its edge is as wide as its dot."""
    SATURATED = "saturated"
    """Named, but the paper beside its dot, or the dot, is burnt out or black on one side."""
    CUT = "cut"
    """Named, but the frame is too near."""
    REPEATED = "repeated"
    """Its name is seen more than once in the picture, so that none of them can be trusted."""
    HIDDEN = "hidden"
    """No name: too many sectors of its ring are hidden."""
    UNKNOWN_CODE = "unknown-code"
    """No name: its ring is no word of the code, or differs from one in too many sectors."""
    AMBIGUOUS = "ambiguous"
    """No name: the sectors that are seen fit two marks nearly as well. Of a plain dot: measured, but several
    dots of another camera could be the same one."""


UNNAMED = (MarkFlag.HIDDEN, MarkFlag.UNKNOWN_CODE, MarkFlag.AMBIGUOUS)
"""Flags of what looks like a mark and has no name."""


@dataclass(frozen=True)
class PictureMarks:
    """The marks of one picture, sorted by name; what has no name comes last, by y, then x.

    Attributes
    ----------
    size : tuple of int
        Width and height of the picture, px.
    point : tuple of str, length n
        Name of the point, as in ``pixels.csv``; empty where there is none. There is at most one ``ok`` point
        to a name.
    position : ndarray, shape (n, 2)
        Of a coded dot the centre of area of its outline, of a tag one of its corners, px; NaN where not
        measured.
    covariance : ndarray, shape (n, 2, 2)
        Covariance of `position`, px squared; NaN where not measured. It holds the noise of the picture. The
        eccentricity of a dot, its centroid minus the image of its centre, is not in it: that follows from
        the surface that the dot lies on, which one mark does not show.
    flag : tuple of MarkFlag, length n
        Flag of the mark.
    seen_at : ndarray, shape (n, 2)
        Rough position, px, also where it is not measured. For drawing only.
    outline : ndarray, shape (n, 2, 2)
        Matrix S of a dot's outline ``(q - c)' inv(S) (q - c) = 1``, px squared; NaN for corners. With
        the dot's diameter it bounds the eccentricity.
    """

    size: tuple[int, int]
    point: tuple[str, ...]
    position: Pixels
    covariance: PixelCovariances
    flag: tuple[MarkFlag, ...]
    seen_at: Pixels
    outline: PixelCovariances

    @property
    def ok(self) -> Mask:
        """Mask of the marks that are measured, shape (n,)."""
        return np.array([flag is MarkFlag.OK for flag in self.flag], dtype=bool)

    def where(self, mask: Mask) -> "PictureMarks":
        """Return the marks where a mask holds, shape (n,)."""
        kept = np.flatnonzero(mask).tolist()
        return PictureMarks(
            self.size,
            tuple(self.point[k] for k in kept),
            self.position[kept],
            self.covariance[kept],
            tuple(self.flag[k] for k in kept),
            self.seen_at[kept],
            self.outline[kept],
        )

    def joined(self, other: "PictureMarks") -> "PictureMarks":
        """Return these marks and, after them, others of the same picture."""
        return PictureMarks(
            self.size,
            self.point + other.point,
            np.concatenate([self.position, other.position]),
            np.concatenate([self.covariance, other.covariance]),
            self.flag + other.flag,
            np.concatenate([self.seen_at, other.seen_at]),
            np.concatenate([self.outline, other.outline]),
        )

    @classmethod
    def empty(cls, size: tuple[int, int]) -> "PictureMarks":
        """Return no marks, of a picture of so many px."""
        return collected([], size)


@dataclass(frozen=True)
class SeenMark:
    """One mark on its way into `PictureMarks`; position and covariance (px) only where it is measured."""

    point: str
    flag: MarkFlag
    seen_at: np.ndarray
    outline: np.ndarray
    position: np.ndarray | None = None
    covariance: np.ndarray | None = None


def collected(marks: list[SeenMark], size: tuple[int, int]) -> PictureMarks:
    """Return marks as arrays, in order; of a name that is seen more than once none is measured."""
    names = [mark.point for mark in marks]
    repeated = {name for name in names if name and names.count(name) > 1}
    marks = [
        SeenMark(mark.point, MarkFlag.REPEATED, mark.seen_at, mark.outline)
        if mark.point in repeated
        else mark
        for mark in marks
    ]
    marks.sort(key=lambda mark: (not mark.point, _in_order(mark.point), mark.seen_at[1], mark.seen_at[0]))
    missing = np.full((2, 2), np.nan)
    position = [missing[0] if mark.position is None else mark.position for mark in marks]
    covariance = [missing if mark.covariance is None else mark.covariance for mark in marks]
    return PictureMarks(
        size=size,
        point=tuple(mark.point for mark in marks),
        position=np.array(position, dtype=np.float64).reshape(-1, 2),
        covariance=np.array(covariance, dtype=np.float64).reshape(-1, 2, 2),
        flag=tuple(mark.flag for mark in marks),
        seen_at=np.array([mark.seen_at for mark in marks], dtype=np.float64).reshape(-1, 2),
        outline=np.array([mark.outline for mark in marks], dtype=np.float64).reshape(-1, 2, 2),
    )


def _in_order(name: str) -> tuple[tuple[int, str], ...]:
    """Return a key by which numbers in names are sorted as numbers."""
    return tuple((int(part), "") if part.isdigit() else (-1, part) for part in name.split("-"))
