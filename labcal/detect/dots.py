"""Result of detection in one picture: dots with positions, covariances, ids and flags."""

from collections import Counter
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float64, Int

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.flags import DotFlag, Refusal, advice
from labcal.targets.grid import Polarity
from labcal.wording import listed


@dataclass(frozen=True)
class OwnPlaces:
    """Dots of several boards side by side by their own boards.

    Attributes
    ----------
    board : ndarray of str, shape (n,)
        Name of the board; empty for a dot without an id.
    index : ndarray of int, shape (n, 2)
        (col, row) on that board.
    """

    board: np.ndarray
    index: Int[np.ndarray, "n 2"]


@dataclass(frozen=True)
class PictureDots:
    """The dots of one picture, sorted by row, then column; dots without an id come last, by y, then x.

    There is at most one dot to an id.

    Attributes
    ----------
    size : tuple of int
        Width and height of the picture, px.
    polarity : Polarity
        Polarity that the picture shows, which need not be the one that the target declares.
    refusal : Refusal or None
        Reason why no dot has an id, or none is measured; None if the picture is indexed.
    index : ndarray of int, shape (n, 2)
        (col, row). Negative indices and those past the end are real where the print goes on beyond the
        declared grid; (0, 0) where `has_id` is false.
    has_id : ndarray of bool, shape (n,)
        Whether `index` means anything.
    position : ndarray, shape (n, 2)
        Centre of area of the dot's outer outline, px; NaN where not measured.
    covariance : ndarray, shape (n, 2, 2)
        Covariance of `position`, px squared; NaN where not measured.
    misfit : ndarray, shape (n,)
        Goodness of fit: standard deviation of a dot's residuals over what is usual among the picture's
        dots in such light. About 1; NaN where not measured, and for corners.
    flag : tuple of DotFlag, length n
        Flag of the dot.
    seen_at : ndarray, shape (n, 2)
        Rough position of the dot, px, also where it is not measured. For drawing only.
    outline : ndarray, shape (n, 2, 2)
        Matrix S of the outer outline ``(q - c)' inv(S) (q - c) = 1``, px squared; NaN for cut dots and
        corners.
    others : tuple of ndarray of int, each of shape (n, 2)
        `index` under every other numbering that fits the picture as well: one of a plain grid that looks the
        same after half a turn, three of a square one; empty if the picture determines it.
    detail : str
        Sentence on what was seen where the picture is refused, for people; may be empty.
    own : OwnPlaces or None
        Of several boards side by side, each dot's own board and index; None of one board.
    part : PictureDots or None
        Of a picture that is refused since it shows a part of a board whose dots are all alike: the dots as
        measured, with ids at one of the places where they fit; its `others` are those at the other places.
    """

    size: tuple[int, int]
    polarity: Polarity
    refusal: Refusal | None
    index: Int[np.ndarray, "n 2"]
    has_id: Mask
    position: Pixels
    covariance: PixelCovariances
    misfit: Float64[np.ndarray, " n"]
    flag: tuple[DotFlag, ...]
    seen_at: Pixels
    outline: PixelCovariances
    others: tuple[Int[np.ndarray, "n 2"], ...] = ()
    detail: str = ""
    own: OwnPlaces | None = None
    part: "PictureDots | None" = None

    @property
    def indexed(self) -> bool:
        """True if dots of this picture have ids."""
        return self.refusal is None

    @property
    def why(self) -> str:
        """The reason of a refusal in sentences: what was seen, what is wrong and how to mend it; or empty."""
        return "" if self.refusal is None else f"{self.detail} {advice(self.refusal)}".strip()

    def renumbered(self, which: int) -> "PictureDots":
        """Return the dots under one of the other numberings, by its number in `others`."""
        index, others = self.others[which], (self.index, *self.others[:which], *self.others[which + 1 :])
        order = np.lexsort((np.where(self.has_id, index[:, 0], 0), index[:, 1], ~self.has_id))
        order[self.has_id.sum() :] = np.flatnonzero(~self.has_id)
        return PictureDots(
            self.size, self.polarity, self.refusal, index[order], self.has_id[order], self.position[order],
            self.covariance[order], self.misfit[order], tuple(self.flag[i] for i in order),
            self.seen_at[order], self.outline[order], tuple(other[order] for other in others),
        )  # fmt: skip

    def refused(self, refusal: Refusal, detail: str = "") -> "PictureDots":
        """Return the dots without ids and positions, for a reason, with a sentence on what was seen."""
        n = len(self.flag)
        return replace(
            self,
            refusal=refusal,
            detail=detail,
            others=(),
            index=np.zeros((n, 2), dtype=np.int64),
            has_id=np.zeros(n, dtype=bool),
            position=np.full((n, 2), np.nan),
            covariance=np.full((n, 2, 2), np.nan),
            misfit=np.full(n, np.nan),
            flag=(DotFlag.NO_ID,) * n,
        )

    def of_board(self, name: str) -> "PictureDots":
        """Return the dots of one of several boards with their own (col, row)."""
        if self.own is None:
            return self
        mine = np.flatnonzero(self.has_id & (self.own.board == name))
        return PictureDots(
            self.size, self.polarity, self.refusal, self.own.index[mine], self.has_id[mine],
            self.position[mine], self.covariance[mine], self.misfit[mine],
            tuple(self.flag[i] for i in mine), self.seen_at[mine], self.outline[mine],
        )  # fmt: skip

    def unusable(self) -> "PictureDots":
        """Return the dots as they were found, but refused: hardly any fits, the others by chance."""
        ok = self.ok
        count = Counter(flag for flag in self.flag if flag not in (DotFlag.OK, DotFlag.NO_ID))
        flags = listed([f"{number} {flag.value}" for flag, number in count.most_common()])
        return replace(
            self,
            refusal=Refusal.NO_USABLE_DOTS,
            detail=f"{int(ok.sum())} of {int(self.has_id.sum())} were measured; not measured: {flags}.",
            others=(),
            position=np.where(ok[:, None], np.nan, self.position),
            covariance=np.where(ok[:, None, None], np.nan, self.covariance),
            misfit=np.where(ok, np.nan, self.misfit),
            flag=tuple(DotFlag.BAD_FIT if flag is DotFlag.OK else flag for flag in self.flag),
        )

    @property
    def ok(self) -> Mask:
        """The dots to calibrate with: measured, and within the declared grid."""
        return np.array([flag is DotFlag.OK for flag in self.flag], dtype=bool)
