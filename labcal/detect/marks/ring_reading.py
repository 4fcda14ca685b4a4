"""The number of a coded dot: from samples of its ring to a word of the code, or to why there is none."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Int

from labcal.arrays import Mask
from labcal.detect.marks.hidden_arcs import most_likely_arcs
from labcal.detect.marks.picture_marks import MarkFlag
from labcal.detect.marks.ring_blur import RingBlur
from labcal.detect.marks.ring_likelihood import ring_likelihoods
from labcal.detect.marks.ring_samples import RingSamples
from labcal.detect.medians import DEVIATIONS_A_MAD
from labcal.detect.stage_settings.mark import MarkSettings
from labcal.targets.ring_codes import CodeBook

_ROUNDS = 2
_FEWEST = 8
"""Samples in sight, by which the noise is measured."""
_GREY = 0.25
"""Most that a sector costs, when likely words are sought: as a grey one does."""

_UNLIKE = 0.5
"""Departure of a hidden ring from the word, as a grey value, from which on it is not like it."""


@dataclass(frozen=True)
class RingReading:
    """Mark that a ring names, or the reason why it names none.

    Attributes
    ----------
    mark : int
        Number of the mark; -1 where there is none.
    flag : MarkFlag or None
        ``ok``, or why the mark has no name; None where the spot is taken for no mark at all.
    evidence : float
        Logarithm of the best word's likelihood over that of a ring of which nothing is in sight, per sample.
    margin : float
        The same over the likelihood of the best word of another mark, of all samples.
    row : int
        That word, as a row of the code book; -1 where there is none.
    start : int
        The sample of the ring that its first sector begins with.
    hidden : ndarray of bool, shape (angles,)
        Samples at which something hides the ring.
    unlike : ndarray of bool, shape (angles,)
        Those of them at which the ring looks otherwise than the word.
    """

    mark: int
    flag: MarkFlag | None
    evidence: float
    margin: float
    row: int
    start: int
    hidden: Mask
    unlike: Mask


NO_MARK = RingReading(-1, None, -np.inf, 0.0, -1, 0, np.ones(0, dtype=bool), np.ones(0, dtype=bool))


def read_ring(samples: RingSamples, blur: RingBlur, book: CodeBook, settings: MarkSettings) -> RingReading:
    """Decide which mark a ring is of.

    Every word, at every start within a sector, has a likelihood: that of the grey values around the dot,
    blurred as the dot is, with the arcs hidden that make it greatest. The best word is the mark's if it is
    far more likely than any word of another mark. So grey values count, and not only bits (soft-decision
    decoding, MacWilliams and Sloane 1977, section 1.3); and a hidden sector is an erasure, of which a code
    bears twice as many as of errors.

    Parameters
    ----------
    samples : RingSamples
    blur : RingBlur
    book : CodeBook
    settings : MarkSettings
    """
    if not has_white_gap(samples, settings):
        return NO_MARK
    start, row = _likely_words(samples, blur, book, settings)
    ink = np.einsum("waj,wj->wa", blur.between[start], book.words[row].astype(np.float64))
    printed = ink * blur.gap, ink * blur.ring, ink * blur.paper
    beside = np.abs(np.concatenate([samples.gap, samples.paper]))
    usual = DEVIATIONS_A_MAD * float(np.nanmedian(beside))
    sigma = np.clip(usual, settings.least_sigma_share, settings.max_sigma_share)
    weight = settings.sample_weight_share
    for _ in range(_ROUNDS):
        seen, covered = ring_likelihoods(samples, printed, float(sigma))
        total, hidden = most_likely_arcs(weight * seen, weight * covered, settings.cover_end_log)
        best = int(np.argmax(total))
        off = (samples.ring - printed[1][best])[~hidden]
        rms = float(np.sqrt(np.mean(off**2))) if len(off) >= _FEWEST else settings.max_sigma_share
        sigma = np.clip(rms, settings.least_sigma_share, settings.max_sigma_share)
    others = total[book.identity[row] != book.identity[row[best]]]
    reading = RingReading(
        mark=int(book.identity[row[best]]),
        flag=MarkFlag.OK,
        evidence=float(total[best] - weight * covered[best].sum()) / len(hidden),
        margin=float(total[best] - others.max()) if len(others) else np.inf,
        row=int(row[best]),
        start=int(start[best]),
        hidden=hidden,
        unlike=hidden & ~(np.abs(samples.ring - printed[1][best]) < _UNLIKE),
    )
    flag = _flag(reading, printed[1][best][~hidden] > 0.5 * blur.ring[~hidden], settings)
    return reading if flag is MarkFlag.OK else replace(reading, flag=flag, mark=-1)


def _flag(reading: RingReading, black: Mask, settings: MarkSettings) -> MarkFlag | None:
    """Return the flag of a reading, by which samples in sight are black, too: a plain ring is no mark."""
    fewest = settings.min_colour_share * len(reading.hidden)
    if reading.evidence < settings.min_sight_log or min(black.sum(), (~black).sum()) < fewest:
        return None
    if reading.hidden.mean() > settings.max_hidden_share:
        return MarkFlag.HIDDEN
    if reading.evidence < settings.min_evidence_log or arcs_with(reading.hidden, reading.unlike) > 1:
        return MarkFlag.UNKNOWN_CODE
    return MarkFlag.AMBIGUOUS if reading.margin < settings.min_margin_log else MarkFlag.OK


def arcs_with(hidden: Mask, unlike: Mask) -> int:
    """Return the number of hidden arcs of a ring in which it looks otherwise than the word.

    What hides a ring hides one arc. A ring that contradicts a word in two places is of another, or of none:
    every seventh ring of chance is within two sectors of some word of a code of 23.

    Parameters
    ----------
    hidden, unlike : ndarray of bool, shape (angles,)
    """
    begins = np.flatnonzero(hidden & ~np.roll(hidden, 1))
    if not len(begins):
        return int(unlike.any())
    turned, marked = np.roll(hidden, -begins[0]), np.roll(unlike, -begins[0])
    arc = np.cumsum(turned & ~np.concatenate([[False], turned[:-1]]))
    return len(np.unique(arc[turned & marked]))


def has_white_gap(samples: RingSamples, settings: MarkSettings) -> bool:
    """Tell whether there is white paper around a spot, without which it is no mark.

    Parameters
    ----------
    samples : RingSamples
    settings : MarkSettings
    """
    white = np.abs(samples.gap) < settings.max_gap_share  # NaN beyond the frame is not
    return bool(np.isfinite(samples.gap).all() and white.mean() >= settings.min_gap_share)


def _likely_words(
    samples: RingSamples, blur: RingBlur, book: CodeBook, settings: MarkSettings
) -> tuple[Int[np.ndarray, " words"], Int[np.ndarray, " words"]]:
    """Return starts and rows of the words that come into question, by rough costs of sectors.

    Blur is undone by least squares with a prior (Tikhonov 1963): a sector of which nothing is known is grey.
    No sector costs more than one that is grey, since it may be hidden.
    """
    mixed = blur.mixing()
    raw = blur.sectors(np.nan_to_num(samples.ring, nan=0.5))
    prior = settings.blur_variance_share * np.eye(mixed.shape[-1])
    transposed = np.swapaxes(mixed, 1, 2)
    off = transposed @ (raw - 0.5 * mixed.sum(axis=-1))[..., None]
    value = np.clip(0.5 + np.linalg.solve(transposed @ mixed + prior, off)[..., 0], 0.0, 1.0)
    white, black = np.minimum(value**2, _GREY), np.minimum((1.0 - value) ** 2, _GREY)
    cost = white.sum(axis=1)[:, None] + (black - white) @ book.words.T.astype(np.float64)
    count = min(settings.candidate_words, cost.size)
    start, row = np.unravel_index(np.argpartition(cost.ravel(), count - 1)[:count], cost.shape)
    return np.asarray(start), np.asarray(row)
