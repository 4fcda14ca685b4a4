"""Dots with their flags on the way into `PictureDots`, in arrays."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64, Int64

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.targets.grid import Polarity


@dataclass(frozen=True)
class FlaggedDots:
    """Dots in any order, as `PictureDots` has them; two may have one place.

    Attributes
    ----------
    place : ndarray of int, shape (n, 2)
        (col, row); (0, 0) where there is none.
    named : ndarray of bool, shape (n,)
        Whether a dot has a place.
    flag : tuple of DotFlag
    seen_at, outline, centre, covariance, misfit : ndarray
        See `PictureDots`; centre, covariance and misfit are NaN where a dot is not measured.
    """

    place: Int64[np.ndarray, "n 2"]
    named: Mask
    flag: tuple[DotFlag, ...]
    seen_at: Pixels
    outline: PixelCovariances
    centre: Pixels
    covariance: PixelCovariances
    misfit: Float64[np.ndarray, " n"]

    @classmethod
    def not_measured(
        cls,
        place: Int64[np.ndarray, "n 2"] | None,
        flag: tuple[DotFlag, ...],
        seen_at: Pixels,
        outline: PixelCovariances,
    ) -> "FlaggedDots":
        """Return dots that are seen only; `place` is None if none of them has one."""
        n = len(seen_at)
        named = np.full(n, place is not None)
        place = np.zeros((n, 2), dtype=np.int64) if place is None else place
        nothing = np.full((n, 2), np.nan), np.full((n, 2, 2), np.nan), np.full(n, np.nan)
        return cls(place, named, flag, seen_at, outline, *nothing)

    def joined(self, others: Sequence["FlaggedDots"]) -> "FlaggedDots":
        """Return these dots and then others."""
        parts = [self, *(other for other in others if len(other.flag) > 0)]
        if len(parts) == 1:
            return self
        return FlaggedDots(
            np.concatenate([part.place for part in parts]),
            np.concatenate([part.named for part in parts]),
            tuple(flag for part in parts for flag in part.flag),
            np.concatenate([part.seen_at for part in parts]),
            np.concatenate([part.outline for part in parts]),
            np.concatenate([part.centre for part in parts]),
            np.concatenate([part.covariance for part in parts]),
            np.concatenate([part.misfit for part in parts]),
        )

    def collected(self, size: tuple[int, int], polarity: Polarity, refusal: Refusal | None) -> PictureDots:
        """Return the dots sorted, with every place at most once: of two dots at one, neither is trusted."""
        place, named, flag = self.place, self.named, self.flag
        order = _order(place, named, self.seen_at)
        sorted_place = place[order]
        twice = (sorted_place[1:] == sorted_place[:-1]).all(axis=1) & named[order[1:]]
        if twice.any():
            wrong = np.union1d(order[1:][twice], order[:-1][twice])
            place, named = place.copy(), named.copy()
            place[wrong], named[wrong] = 0, False
            unnamed = set(wrong.tolist())
            flag = tuple(DotFlag.NO_ID if k in unnamed else flag[k] for k in range(len(flag)))
            order = _order(place, named, self.seen_at)
        return PictureDots(
            size=size,
            polarity=polarity,
            refusal=refusal,
            index=place[order],
            has_id=named[order],
            position=self.centre[order],
            covariance=self.covariance[order],
            misfit=self.misfit[order],
            flag=tuple([flag[k] for k in order.tolist()]),
            seen_at=self.seen_at[order],
            outline=self.outline[order],
        )


def _order(place: Int64[np.ndarray, "n 2"], named: Mask, seen_at: Pixels) -> Int64[np.ndarray, " n"]:
    """Return the order of dots: by row, then column; those without a place last, by y, then x."""
    order: np.ndarray = np.lexsort((seen_at[:, 0], seen_at[:, 1], place[:, 0], place[:, 1], ~named))
    return order
