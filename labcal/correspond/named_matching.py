"""Named pixels by point: a row for each point of a view, with its pixel in every camera that has one."""

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import repeat

import numpy as np
from jaxtyping import Bool, Float64, Int64

from labcal.correspond.matching import Matches
from labcal.correspond.named_pixels import NamedPixels
from labcal.errors import InputError
from labcal.wording import clipped, printable


@dataclass(frozen=True)
class NamedMatches:
    """Points of views, in order of appearance in the table."""

    cameras: tuple[str, ...]
    view: np.ndarray
    """(n,) of str"""
    name: np.ndarray
    """(n,) of str"""
    q: Float64[np.ndarray, "n cameras 2"]
    """Pixels; NaN where the camera has none."""
    covariance: Float64[np.ndarray, "n cameras 2 2"]
    """Of the pixels, px squared; NaN where the camera has none."""
    seen: Bool[np.ndarray, "n cameras"]
    """Mask of the pixels that are used."""

    def __len__(self) -> int:
        return len(self.view)

    def groups(self) -> list[tuple[tuple[int, ...], Int64[np.ndarray, " rows"]]]:
        """Return the rows that the same cameras see, by the numbers of these cameras."""
        if not len(self):
            return []
        patterns, number = np.unique(self.seen, axis=0, return_inverse=True)
        return [
            (tuple(np.flatnonzero(pattern).tolist()), np.flatnonzero(number.ravel() == at))
            for at, pattern in enumerate(patterns)
        ]

    def matches(self, cameras: tuple[int, ...], rows: Int64[np.ndarray, " rows"]) -> Matches:
        """Return points that some cameras see as the table that rigs and methods take.

        In place of column and row, which named points do not have, stand the number of the row here, and 0.
        """
        chosen = list(cameras)
        return Matches(
            tuple(self.cameras[at] for at in cameras),
            self.view[rows],
            np.column_stack([rows, np.zeros_like(rows)]),
            self.q[rows][:, chosen],
            self.covariance[rows][:, chosen],
        )


def match_named(pixels: NamedPixels, cameras: Sequence[str]) -> NamedMatches:
    """Return the points of named pixels, with what each of some cameras sees of them.

    Parameters
    ----------
    pixels : NamedPixels
        A line without a position is that of a point that was not measured there.
    cameras : sequence of str
        The cameras wanted, in the order of the columns; pixels of others do not count.

    Raises
    ------
    InputError
        A point is listed twice for a picture.
    """
    place = {name: number for number, name in enumerate(cameras)}
    camera = np.fromiter(
        map(place.get, pixels.camera.tolist(), repeat(-1)), dtype=np.int64, count=len(pixels)
    )
    names = int(pixels.point_number.max(initial=0)) + 1
    keys, first, point = np.unique(
        pixels.view_number * names + pixels.point_number, return_index=True, return_inverse=True
    )
    order = np.argsort(first, kind="stable")
    rank = np.empty_like(order)
    rank[order] = np.arange(len(order))
    used = np.flatnonzero((camera >= 0) & np.isfinite(pixels.position).all(axis=1))
    row, column = rank[point[used]], camera[used]
    _refuse_repeated(pixels, used, row * len(place) + column)
    q = np.full((len(keys), len(place), 2), np.nan)
    covariance = np.full((len(keys), len(place), 2, 2), np.nan)
    seen = np.zeros((len(keys), len(place)), dtype=bool)
    q[row, column], covariance[row, column] = pixels.position[used], pixels.covariance[used]
    seen[row, column] = True
    shown = first[order]
    return NamedMatches(tuple(cameras), pixels.view[shown], pixels.point[shown], q, covariance, seen)


def _refuse_repeated(
    pixels: NamedPixels, lines: Int64[np.ndarray, " n"], key: Int64[np.ndarray, " n"]
) -> None:
    """Raise where two lines are of the same point in a picture."""
    if not len(key) or np.bincount(key).max() == 1:
        return
    order = np.argsort(key, kind="stable")
    again = np.flatnonzero(np.diff(key[order]) == 0)
    if len(again):
        line = lines[order[again[0] + 1]]
        raise InputError(
            f"The point '{clipped(printable(pixels.point[line]))}' is listed twice for view "
            f"'{clipped(printable(pixels.view[line]))}' of camera '{pixels.camera[line]}'. A name is that of "
            "one point in a picture: keep one line."
        )
