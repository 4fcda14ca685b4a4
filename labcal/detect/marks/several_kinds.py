"""Marks of several kinds in one picture."""

from collections.abc import Sequence

import numpy as np

from labcal.arrays import Mask
from labcal.detect.grey import AnyPicture, grey_picture
from labcal.detect.marks.mark_kinds import MarkKind, PlainDots
from labcal.detect.marks.picture_marks import PictureMarks
from labcal.detect.settings import DEFAULTS, DetectSettings
from labcal.targets.coded_dots import RING_OUTER

_CORNERS = 4


def find_marks(
    image: AnyPicture, kinds: Sequence[MarkKind], settings: DetectSettings | None = None
) -> PictureMarks:
    """Find marks of all kinds that are given in one picture.

    Parameters
    ----------
    image : ndarray, shape (h, w), (h, w, 3) or (h, w, 4)
        uint8, uint16 or float; colour in any order.
    kinds : sequence of MarkKind
        From :func:`~labcal.detect.marks.mark_kinds.mark_kinds`: plain dots come last, since a dot, or a part
        of a ring or of a tag, is not one of them.
    settings : DetectSettings, optional

    Returns
    -------
    PictureMarks
        Kind by kind.

    Raises
    ------
    InputTypeError, InputError
        `image` is no picture (see :func:`labcal.detect.grey.grey_picture`).
    """
    settings = DEFAULTS if settings is None else settings
    grey = grey_picture(image)
    found: PictureMarks | None = None
    for kind in kinds:
        own = kind.find(grey, settings)
        if isinstance(kind, PlainDots) and found is not None:
            own = own.where(~_in_marks(own.seen_at, found))
        found = own if found is None else found.joined(own)
    return PictureMarks.empty((grey.shape[1], grey.shape[0])) if found is None else found


def _in_marks(q: np.ndarray, marks: PictureMarks) -> Mask:
    """Tell which pixels (n, 2) lie in the ring of a coded dot, or in a tag."""
    inside = np.zeros(len(q), dtype=bool)
    round_ = np.isfinite(marks.outline).all(axis=(1, 2))
    for centre, S in zip(marks.seen_at[round_], marks.outline[round_], strict=True):
        away = q - centre
        inside |= np.einsum("ni,ni->n", away, np.linalg.solve(S, away.T).T) < RING_OUTER**2
    for quad in _quads(marks):
        edge = np.roll(quad, -1, axis=0) - quad
        away = q[:, None] - quad
        side = edge[:, 0] * away[..., 1] - edge[:, 1] * away[..., 0]
        inside |= (side > 0.0).all(axis=1) | (side < 0.0).all(axis=1)
    return inside


def _quads(marks: PictureMarks) -> list[np.ndarray]:
    """Return the corners of every tag of which all are seen, (4, 2) each."""
    corners: dict[str, list[np.ndarray]] = {}
    for name, q, S in zip(marks.point, marks.seen_at, marks.outline, strict=True):
        if name and np.isnan(S).any():
            corners.setdefault(name.rpartition("-")[0], []).append(q)
    return [np.array(quad) for quad in corners.values() if len(quad) == _CORNERS]
