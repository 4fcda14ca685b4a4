"""A sheet of coded dots as a target: every dot is numbered by its own ring."""

from dataclasses import replace

import numpy as np

from labcal.arrays import Mask
from labcal.detect.corners.markers_elsewhere import ids_read
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.detect.grey import GreyPicture
from labcal.detect.lattice.lattice import Lattice
from labcal.detect.lattice.smoothness import is_smooth, is_smooth_through_fisheye
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.detect.marks.picture_marks import MarkFlag, PictureMarks
from labcal.detect.marks.sheet_agreement import agreement
from labcal.detect.settings import DetectSettings
from labcal.targets.coded_dots import CodedDots
from labcal.targets.grid import Polarity
from labcal.wording import counted

_FLAGS = {
    MarkFlag.OK: DotFlag.OK,
    MarkFlag.BAD_FIT: DotFlag.BAD_FIT,
    MarkFlag.BLURRED: DotFlag.BLURRED,
    MarkFlag.SATURATED: DotFlag.SATURATED,
}
"""Flags of dots with a number; all other marks are ``no-id``."""
_FEWEST = 4  # dots, not on a line: what a homography takes
_MOST_ASTRAY = 0.25
"""Share of the dots with a name that are not in their places, above which it is another sheet.

Marks that the sheet does not have are evidence enough beside a single one.
"""


def detect_coded_sheet(grey: GreyPicture, sheet: CodedDots, settings: DetectSettings) -> PictureDots:
    """Find the dots of a sheet in one picture, each by its ring.

    A dot that is not where the dots around it have it on the sheet is left without an id.

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
        Refused where no mark of the sheet is read, where more than a quarter of them are not in the sheet's
        places, or as in a mirror, where fewer than four dots, or dots of one line only, are measured, and
        where they lie on no smooth surface.
    """
    marks = find_coded_dots(grey, sheet.code, settings)
    number = _numbers(marks)
    dots = _dots(marks, _places(number, sheet), sheet)
    numbers = sorted(set(number[number >= 0].tolist()))
    own = sheet.first_mark, sheet.first_mark + sheet.count - 1
    detail = ids_read("Mark", numbers, str(sheet.code), own) if numbers else ""
    if not dots.has_id.any():
        return dots.refused(*_why_none(grey, sheet, settings, detail))
    found = np.flatnonzero(dots.has_id & np.isfinite(dots.outline).all(axis=(1, 2)))
    compared = agreement(
        dots.index[found] * (2.0 * sheet.pitch_mm / sheet.dot_diameter_mm),
        dots.seen_at[found],
        dots.outline[found],
    )
    astray = found[~compared.ok]
    if compared.mirrored:
        return dots.refused(Refusal.MIRRORED, detail)
    foreign = numbers[0] < own[0] or numbers[-1] > own[1]
    if len(astray) > (0.0 if foreign else _MOST_ASTRAY) * len(found):
        detail += f" {len(astray)} of {len(found)} are not where the target has them."
        return dots.refused(Refusal.OTHER_BOARD, detail)
    dots = _without_ids(dots, astray)
    index = dots.index[dots.ok]
    if len(index) < _FEWEST or np.linalg.matrix_rank(index - index[0]) < 2:  # noqa: PLR2004 -- a plane
        seen = counted(int(dots.has_id.sum()), "coded dot") + f" of {sheet.count} "
        seen += f"{'was' if dots.has_id.sum() == 1 else 'were'} read, {len(index)} of them measured; "
        return dots.refused(Refusal.TOO_FEW_DOTS, seen + "four that are not on a line are needed.")
    if _is_smooth(dots, settings):
        return dots
    return dots.refused(Refusal.OTHER_BOARD if foreign else Refusal.GRID_INCONSISTENT, detail)


def _numbers(marks: PictureMarks) -> np.ndarray:
    """Return the numbers of marks, shape (n,); -1 where one has none that counts."""
    return np.array(
        [
            int(name.rpartition("-")[2]) if name and flag in _FLAGS else -1
            for name, flag in zip(marks.point, marks.flag, strict=True)
        ],
        dtype=np.int64,
    )


def _places(number: np.ndarray, sheet: CodedDots) -> np.ndarray:
    """Return the places of marks on a sheet, by their numbers; -1 for those that it does not have."""
    place = number - sheet.first_mark
    return np.where((number >= 0) & (place >= 0) & (place < sheet.count), place, -1)


def _why_none(
    grey: GreyPicture, sheet: CodedDots, settings: DetectSettings, detail: str
) -> tuple[Refusal, str]:
    """Return why no mark of a sheet is read: seen in a mirror, marks of another sheet, or none at all."""
    turned = find_coded_dots(np.ascontiguousarray(grey[:, ::-1]), sheet.code, settings)
    read = int((_places(_numbers(turned), sheet) >= 0).sum())
    if read >= _FEWEST:
        return Refusal.MIRRORED, f"In a mirror {counted(read, 'coded dot')} of {sheet.count} can be read."
    return (Refusal.OTHER_IDS if detail else Refusal.NO_CODED_DOTS), detail


def _is_smooth(dots: PictureDots, settings: DetectSettings) -> bool:
    """Tell whether the measured dots lie on one smooth surface of the picture."""
    ok = np.flatnonzero(dots.ok)
    lattice = Lattice({(int(dots.index[k, 0]), int(dots.index[k, 1])): int(k) for k in ok})
    return is_smooth(lattice, dots.position, settings.grid) or is_smooth_through_fisheye(
        lattice, dots.position, dots.size, settings.grid
    )


def _without_ids(dots: PictureDots, which: np.ndarray) -> PictureDots:
    """Return dots of which some, by number, have no id; they come last."""
    if len(which) == 0:
        return dots
    kept: Mask = np.ones(len(dots.flag), dtype=bool)
    kept[which] = False
    has_id = dots.has_id & kept
    order = np.argsort(~has_id, kind="stable")
    return replace(
        dots,
        index=np.where(has_id[:, None], dots.index, 0)[order],
        has_id=has_id[order],
        position=np.where(kept[:, None], dots.position, np.nan)[order],
        covariance=np.where(kept[:, None, None], dots.covariance, np.nan)[order],
        misfit=dots.misfit[order],
        flag=tuple(dots.flag[k] if kept[k] else DotFlag.NO_ID for k in order.tolist()),
        seen_at=dots.seen_at[order],
        outline=dots.outline[order],
    )


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
