"""Dots of a sheet that are where the sheet has them, as seen from the dots around them."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float64, Int

from labcal.arrays import Mask, PixelCovariances, Pixels
from labcal.detect.matrices import geometric_means
from labcal.geometry.two_by_two import inverses, matrix_roots

_NEAREST = 4
"""Dots in the picture that a dot is compared with."""
_LARGEST_LOG = 0.2
"""Log of the ratio of a distance to that on the sheet: the next dot but one is 0.35 further away."""
_LEAST_TURN = 0.2
"""Sine of the angle between two steps, below which they do not tell a mirrored sheet."""


@dataclass(frozen=True)
class Agreement:
    """Dots of a sheet compared with one another.

    Attributes
    ----------
    ok : ndarray of bool, shape (n,)
        Dots at the right distances from the dots around them.
    mirrored : bool
        Whether most of those show the sheet as in a mirror.
    """

    ok: Mask
    mirrored: bool


def agreement(place: Float64[np.ndarray, "n 2"], q: Pixels, outline: PixelCovariances) -> Agreement:
    """Compare distances between neighbouring dots in a picture with those on their sheet.

    The ellipse of a dot shows how the sheet is foreshortened there, and its size is known: a distance in
    units of the ellipses at its ends is that on the sheet, whatever the perspective and the lens.

    Parameters
    ----------
    place : ndarray, shape (n, 2)
        On the sheet, by the dots' names, in radii of a dot, y up.
    q : ndarray, shape (n, 2)
        px.
    outline : ndarray, shape (n, 2, 2)
        Outline matrices of the dots, px squared.
    """
    n = len(place)
    if n < 2:  # noqa: PLR2004 -- a pair
        return Agreement(np.ones(n, dtype=bool), mirrored=False)
    flatten = inverses(matrix_roots(outline))
    away = np.linalg.norm(q[:, None] - q, axis=-1)
    near = np.argsort(away, axis=1, kind="stable")[:, 1 : _NEAREST + 1]
    here = np.repeat(np.arange(n), near.shape[1])
    there = near.ravel()
    pairs = np.unique(np.sort(np.stack([here, there], axis=1), axis=1), axis=0)
    between = geometric_means(flatten[pairs[:, 0]], flatten[pairs[:, 1]])
    seen = np.linalg.norm(np.einsum("nij,nj->ni", between, q[pairs[:, 1]] - q[pairs[:, 0]]), axis=1)
    printed = np.linalg.norm(place[pairs[:, 1]] - place[pairs[:, 0]], axis=1)
    fits = np.abs(np.log(seen / np.maximum(printed, 1e-9))) < _LARGEST_LOG
    ok = _without_worst(pairs, fits, n)
    return Agreement(ok, _is_mirrored(place, q, near, ok))


def _without_worst(
    pairs: Int[np.ndarray, "m 2"], fits: Bool[np.ndarray, " m"], n: int
) -> Bool[np.ndarray, " n"]:
    """Return which dots are left when those with most misfits, and most of them, are left out in turn."""
    ok = np.ones(n, dtype=bool)
    while True:
        alive = ok[pairs].all(axis=1)
        wrong = np.bincount(pairs[alive & ~fits].ravel(), minlength=n)
        every = np.bincount(pairs[alive].ravel(), minlength=n)
        if not wrong.any():
            return ok
        share = wrong / np.maximum(every, 1)
        ok[np.lexsort((share, wrong))[-1]] = False


def _is_mirrored(
    place: Float64[np.ndarray, "n 2"], q: Pixels, near: Int[np.ndarray, "n k"], ok: Bool[np.ndarray, " n"]
) -> bool:
    """Tell whether most triples of neighbours turn the other way round than on the sheet."""
    votes = 0
    for k in np.flatnonzero(ok):
        others = [int(one) for one in near[k] if ok[one]]
        for first, second in ((a, b) for i, a in enumerate(others) for b in others[i + 1 :]):
            sheet, picture = (_sine(x[first] - x[k], x[second] - x[k]) for x in (place, q))
            if min(abs(sheet), abs(picture)) > _LEAST_TURN:
                votes += 1 if sheet * picture > 0.0 else -1  # y is up on the sheet and down in the picture
    return votes > 0


def _sine(first: np.ndarray, second: np.ndarray) -> float:
    """Return the sine of the angle from one step to another."""
    cross = float(first[0] * second[1] - first[1] * second[0])
    return cross / max(float(np.linalg.norm(first) * np.linalg.norm(second)), 1e-12)
