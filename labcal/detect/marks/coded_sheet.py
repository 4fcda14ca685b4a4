"""A sheet of coded dots as a target: every dot is numbered by its own ring."""

import numpy as np

from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.detect.marks.picture_marks import MarkFlag, PictureMarks
from labcal.detect.settings import DetectSettings
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import Polarity

_FLAGS = {
    MarkFlag.OK: DotFlag.OK,
    MarkFlag.BAD_FIT: DotFlag.BAD_FIT,
    MarkFlag.BLURRED: DotFlag.BLURRED,
    MarkFlag.SATURATED: DotFlag.SATURATED,
}
"""Flags of dots with a number; all other marks are ``no-id``."""
_FEWEST = 4  # dots, not on a line: what a homography takes


def detect_coded_sheet(grey: GreyPicture, sheet: CodedDots, settings: DetectSettings) -> PictureDots:
    """Find the dots of a sheet in one picture, each by its ring.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    sheet : CodedDots
        The sheet to look for. Marks of its code that it does not have are left out.
    settings : DetectSettings

    Returns
    -------
    PictureDots
        Refused where no mark of the sheet is read, and where fewer than four dots, or dots of one line only,
        are measured.
    """
    marks = find_coded_dots(grey, sheet.code, settings)
    number = np.array([int(name.rpartition("-")[2]) if name else -1 for name in marks.point], dtype=np.int64)
    named = np.array([flag in _FLAGS for flag in marks.flag], dtype=bool)
    place = number - sheet.first_mark
    held = (place >= 0) & (place < sheet.count)
    dots = _dots(marks, np.where(named & held, place, -1), sheet)
    if not dots.has_id.any():
        return dots.refused(Refusal.NO_CODED_DOTS)
    index = dots.index[dots.ok]
    if len(index) < _FEWEST or np.linalg.matrix_rank(index - index[0]) < 2:  # noqa: PLR2004 -- a plane
        return dots.refused(Refusal.TOO_FEW_DOTS)
    return dots


def _dots(marks: PictureMarks, place: np.ndarray, sheet: CodedDots) -> PictureDots:
    """Return marks as dots, row by row, those of no place on the sheet last."""
    has_id = place >= 0
    unnamed = ~np.array([bool(name) for name in marks.point], dtype=bool)
    repeated = np.array([flag is MarkFlag.REPEATED for flag in marks.flag], dtype=bool)
    kept = np.flatnonzero(has_id | unnamed | repeated)
    order = kept[np.lexsort((marks.seen_at[kept, 0], marks.seen_at[kept, 1], place[kept], ~has_id[kept]))]
    row, col = np.divmod(np.where(has_id[order], place[order], 0), sheet.cols)
    return PictureDots(
        size=marks.size,
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=None,
        index=np.stack([col, row], axis=-1).astype(np.int64).reshape(-1, 2),
        has_id=has_id[order],
        position=np.where(has_id[order, None], marks.position[order], np.nan),
        covariance=np.where(has_id[order, None, None], marks.covariance[order], np.nan),
        misfit=np.full(len(order), np.nan),
        flag=tuple(_FLAGS[marks.flag[k]] if has_id[k] else DotFlag.NO_ID for k in order.tolist()),
        seen_at=marks.seen_at[order],
        outline=marks.outline[order],
    )
