"""What detection finds in one picture: dots with positions, covariances, ids and flags."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Int

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.flags import DotFlag, Refusal
from labcal.targets.grid import Polarity


@dataclass(frozen=True)
class PictureDots:
    """The dots of one picture, sorted by row, then column; dots without an id come last, by y, then x.

    There is at most one dot to an id.

    Attributes
    ----------
    size : tuple of int
        Width and height of the picture, px.
    polarity : Polarity
        What the picture shows, which need not be what the target declares.
    refusal : Refusal or None
        Why no dot has an id; None where the picture is indexed.
    index : ndarray of int, shape (n, 2)
        (col, row). Negative indices and those past the end are real where the print goes on beyond the
        declared grid; (0, 0) where `has_id` is false.
    has_id : ndarray of bool, shape (n,)
        Whether `index` means anything.
    position : ndarray, shape (n, 2)
        Centre of area of the dot's outer outline, px; NaN where not measured.
    covariance : ndarray, shape (n, 2, 2)
        Covariance of `position`, px squared; NaN where not measured.
    flag : tuple of DotFlag, length n
        What became of the dot.
    seen_at : ndarray, shape (n, 2)
        Roughly where the dot is, px, also where it is not measured. For drawing only.
    outline : ndarray, shape (n, 2, 2)
        Matrix S of the outer outline ``(q - c)' inv(S) (q - c) = 1``, px squared; NaN for cut dots.
    """

    size: tuple[int, int]
    polarity: Polarity
    refusal: Refusal | None
    index: Int[np.ndarray, "n 2"]
    has_id: Mask
    position: Pixels
    covariance: PixelCovariances
    flag: tuple[DotFlag, ...]
    seen_at: Pixels
    outline: PixelCovariances

    @property
    def indexed(self) -> bool:
        """Whether dots of this picture have ids."""
        return self.refusal is None

    @property
    def ok(self) -> Mask:
        """The dots to calibrate with: measured, and within the declared grid."""
        return np.array([flag is DotFlag.OK for flag in self.flag], dtype=bool)
