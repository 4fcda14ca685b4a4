"""The number of a coded dot: from samples of its ring to a word of the code, or to why there is none."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from labcal.arrays import Mask
from labcal.detect.marks.picture_marks import MarkFlag
from labcal.detect.marks.ring_blur import MIDDLE, samples_of_sectors
from labcal.detect.marks.ring_samples import PER_SECTOR, RingSamples
from labcal.detect.stage_settings.mark import MarkSettings
from labcal.targets.ring_codes import CodeBook

_USUAL_TIMES = 4.0
"""Of the median departure of paper beside a ring from white: so much of it something else shows."""


@dataclass(frozen=True)
class RingReading:
    """Mark that a ring names, or the reason why it names none.

    Attributes
    ----------
    mark : int
        Number of the mark; -1 where there is none.
    flag : MarkFlag or None
        ``ok``, or why the mark has no name; None where the spot is taken for no mark at all.
    cost : float
        Mean squared departure of the sectors in sight from the best word.
    row : int
        That word, as a row of the code book; -1 where there is none.
    start : int
        The sample of the ring that its first sector begins with.
    """

    mark: int
    flag: MarkFlag | None
    cost: float
    row: int = -1
    start: int = 0


NO_MARK = RingReading(-1, None, np.inf)


def read_ring(
    samples: RingSamples,
    mixed: Float64[np.ndarray, "starts sectors sectors"],
    book: CodeBook,
    settings: MarkSettings,
) -> RingReading:
    """Decide which mark a ring is of.

    Sectors are read at every start within a sector. A sector is left out where paper beside the ring, on
    either side of it, is not white, or where its own grey value is none of the print: something hides it.
    The word that fits the others best, by least squares, is the mark's, if next to no sector in sight
    contradicts it and no word of another mark fits nearly as well. So grey values count, and not only bits
    (soft-decision decoding, MacWilliams and Sloane 1977, section 1.3); and a hidden sector is an erasure,
    of which a code bears twice as many as of errors.

    Parameters
    ----------
    samples : RingSamples
    mixed : ndarray, shape (starts, sectors, sectors)
        By which blur mixes the sectors (:func:`~labcal.detect.marks.ring_blur.mixing`).
    book : CodeBook
    settings : MarkSettings
    """
    if not has_white_gap(samples, settings):
        return NO_MARK
    hidden = _is_hidden(samples, settings)
    value, raw, in_sight = _sectors(samples.ring, ~hidden, mixed, settings.blur_variance_share)
    black = value[in_sight] > 0.5  # noqa: PLR2004 -- half-way
    if in_sight.mean() < settings.min_sight_share or black.all() or not black.any():
        return NO_MARK
    best, cost, words = _best_words(value, in_sight, book)
    start = int(np.argmin(cost))
    row, seen = int(words[start]), in_sight[start]
    off = (raw[start] - mixed[start] @ book.words[row])[seen]
    wrong = int(((value[start] > 0.5) != book.words[row])[seen].sum())  # noqa: PLR2004 -- half-way
    number = int(book.words[row][seen].sum())
    others = best[start, book.identity != book.identity[row]].min()
    margin = (1.0 + 0.5 * wrong) * settings.min_margin_sectors
    if seen.mean() < 1.0 - settings.max_hidden_share:
        flag = MarkFlag.HIDDEN
    elif wrong > settings.max_wrong_sectors or float(np.sqrt((off**2).mean())) > settings.max_residual_share:
        flag = MarkFlag.UNKNOWN_CODE
    elif others - best[start, row] < margin:
        flag = MarkFlag.AMBIGUOUS
    elif min(number, int(seen.sum()) - number) < settings.min_colour_share * len(seen):
        flag = MarkFlag.UNKNOWN_CODE
    else:
        flag = MarkFlag.OK
    mark = int(book.identity[row]) if flag is MarkFlag.OK else -1
    return RingReading(mark, flag, float(cost[start]), row, start)


def has_white_gap(samples: RingSamples, settings: MarkSettings) -> bool:
    """Tell whether there is white paper around a spot, without which it is no mark.

    Parameters
    ----------
    samples : RingSamples
    settings : MarkSettings
    """
    white = np.abs(samples.gap) < settings.hidden_level_share  # NaN beyond the frame is not
    return bool(np.isfinite(samples.gap).all() and white.mean() >= settings.min_gap_share)


def _is_hidden(samples: RingSamples, settings: MarkSettings) -> Mask:
    """Tell at which angles something hides the ring: NaN beyond the frame counts as such.

    That is where paper beside the ring is not white, and the ring is as grey as what is seen beside it;
    or where the ring is darker or brighter than the print. How white paper is depends on the blur, by which
    black sectors shine through, and on the noise: the spread of the grey values around the dot shows both.
    """
    beside = _smoothed(np.stack([samples.gap, samples.paper]))
    ring = _smoothed(samples.ring)
    usual = float(np.nanmedian(np.abs(beside)))
    level = np.clip(_USUAL_TIMES * usual, settings.least_hidden_share, settings.hidden_level_share)
    covered = (np.abs(beside) > level) & (np.abs(ring - beside) < settings.cover_likeness_share)
    off = np.abs(ring - 0.5) - 0.5
    hidden: Mask = covered.any(axis=0) | ~(off < settings.ring_overshoot_share)
    return hidden


def _smoothed(values: np.ndarray) -> np.ndarray:
    """Return running means along half a sector, the last axis being a circle."""
    half = PER_SECTOR // 4
    shifted = [np.roll(values, k, axis=-1) for k in range(-half, half + 1)]
    return np.asarray(np.mean(shifted, axis=0))


def _sectors(
    ring: np.ndarray, clear: np.ndarray, mixed: np.ndarray, regularisation: float
) -> tuple[np.ndarray, np.ndarray, Mask]:
    """Return grey values of sectors, without blur and with it, and which are in sight, (starts, sectors).

    Blur is undone by least squares with a prior (Tikhonov 1963): a sector of which nothing is known is grey.
    """
    at = samples_of_sectors(len(ring) // PER_SECTOR)
    seen = clear[at]
    weight = seen.sum(axis=-1)
    value = np.where(seen, ring[at], 0.0).sum(axis=-1) / np.maximum(weight, 1)
    in_sight = weight > MIDDLE // 2
    A = np.where(in_sight[..., None], mixed, 0.0)
    off = np.where(in_sight, value - 0.5 * A.sum(axis=-1), 0.0)
    normal = np.swapaxes(A, 1, 2) @ A + regularisation * np.eye(A.shape[-1])
    sharp = np.linalg.solve(normal, np.einsum("sij,si->sj", A, off)[..., None])[..., 0]
    return 0.5 + sharp, value, in_sight


def _best_words(
    value: np.ndarray, in_sight: np.ndarray, book: CodeBook
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return every word's cost at every start, and the least mean cost with its word at every start."""
    clipped = np.where(in_sight, np.clip(value, 0.0, 1.0), 0.0)
    gain = np.where(in_sight, 1.0 - 2.0 * clipped, 0.0)
    each = gain @ book.words.T.astype(np.float64)
    each += (clipped**2).sum(axis=1)[:, None]
    words = np.argmin(each, axis=1)
    cost = each[np.arange(len(each)), words] / np.maximum(in_sight.sum(axis=1), 1)
    return each, cost, words
