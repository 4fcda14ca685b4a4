"""Groupings of views that explain why the pose between two cameras was not the same in all of them."""

from math import comb

import numpy as np
from jaxtyping import Float64, Int64

from labcal.calibrate.adjustment.state import POSE
from labcal.calibrate.agreement.pair import PairAgreement
from labcal.distributions import beta_tail, f_tail

FALSE_ALARMS = 1e-6
"""Chance from which on cameras disagree: of a million good pairs one is accused."""
EXPLAINED = 1e-4
"""Chance from which on views agree with each other, once something explains what they did not."""
_MODELLED_TIMES = 4.0
"""Times the variance that errors explain, from which on a contradiction is worth a word, where each camera
alone shows nothing that is not as modelled: of 100 good sets the worst came to 1.4, and what makes lengths
worse by a fifth is some twenty times."""
LEAST_TIMES = 7.0
"""The same where smooth errors are twice what they should be, or more: models are never quite those of real
cameras and prints."""
NOT_RIGID_TIMES = 20.0
"""The same where dots had to be found on the print, or cameras alone show that the board or the lens is not
as modelled: a sheet of paper bends from view to view. Only what increases errors of lengths
by a fifth is reported."""
SMOOTH = 3.0
"""Inflation from which on the lens model, or the flat board, does not suit."""
MOST_INCONSISTENT = 0.2
"""Largest share of views that are inconsistent with the others; beyond it, none is known to be right."""
_TIMES_INCONSISTENT = 20.0
"""Times the misfit that errors explain, from which on a view is inconsistent."""
_FEWEST = 5
"""Number of shared views that is enough to identify an inconsistent one."""
_VIEWS_A_MOVE = 3
"""Least average number of views between moves of a camera."""
_NO_CHANCE = 0.05
"""Chance from which on it is not by chance that a move explains what it does."""
_TELLING = 3.0
"""Times the misfit that errors explain, from which on a view is named."""


def together(pair: PairAgreement) -> Int64[np.ndarray, " n"]:
    """Return the grouping in which all views have one pose."""
    return np.zeros(len(pair.poses.views), dtype=np.int64)


def disagrees(pair: PairAgreement, pairs: int = 1, *, freed: bool = False) -> bool:
    """Tell whether views contradict each other.

    Parameters
    ----------
    pair : PairAgreement
    pairs : int
        How many pairs of cameras are asked.
    freed : bool
        Whether dots had to be found on the print.
    """
    if freed or pair.smooth.inflation > SMOOTH:
        least = NOT_RIGID_TIMES
    else:
        least = float(np.interp(pair.smooth.inflation, (1.0, 2.0), (_MODELLED_TIMES, LEAST_TIMES)))
    return times(pair) > least and pair.chance(together(pair)) < FALSE_ALARMS / pairs


def times(pair: PairAgreement) -> float:
    """Return the factor by which the variance between views exceeds the errors."""
    groups = together(pair)
    return pair.misfit(groups) / (POSE * (len(groups) - 1)) / pair.inflation


def inconsistent_views(pair: PairAgreement) -> list[int]:
    """Return indices of the few views that contradict all others, which agree; none if there are no few."""
    groups = together(pair)
    if len(groups) < _FEWEST:
        return []
    inconsistent: list[int] = []
    while True:
        gain = _gains(pair, groups)
        gain[inconsistent] = 0.0
        best = int(np.argmax(gain))
        surely = _chance_of_view(pair, float(gain[best])) < FALSE_ALARMS / len(groups)
        if not surely or gain[best] < _TIMES_INCONSISTENT * POSE * pair.inflation:
            break
        inconsistent.append(best)
        groups = _alone(groups, best)
        if len(inconsistent) > max(1, int(MOST_INCONSISTENT * len(groups))):
            return []
    freedom = POSE * (len(groups) - 1 - len(inconsistent))
    agree = pair.misfit(groups) <= LEAST_TIMES * freedom * pair.inflation
    return sorted(inconsistent) if agree else []


def moves(pair: PairAgreement) -> Int64[np.ndarray, " n"]:
    """Return views grouped by moves of a camera between them, as few as make the rest agree.

    Where no few do, the grouping of the one that explains most.
    """
    first = groups = _split(pair, together(pair))
    while pair.chance(groups) < EXPLAINED:
        if 1 + groups.max() >= len(groups) // _VIEWS_A_MOVE:
            return first
        groups = _split(pair, groups)
    return groups


def explained(pair: PairAgreement, groups: Int64[np.ndarray, " n"]) -> float:
    """Return the share of unexplained variance that a grouping explains."""
    all_ = together(pair)
    expected = POSE * (len(all_) - 1) * pair.inflation
    return (pair.misfit(all_) - pair.misfit(groups)) / max(pair.misfit(all_) - expected, 1e-300)


def surely(pair: PairAgreement, groups: Int64[np.ndarray, " n"]) -> bool:
    """Tell whether chance would hardly let moves of a camera explain so much of what is no move.

    Of views that differ at random a grouping explains a share that follows a beta distribution. Most of the
    misfit may come from one direction in which views are known best: each view counts once, not six times.
    The grouping is the best of all with as many moves. Of so few views that one difference is left, two may
    agree by chance.
    """
    count = int(groups.max())
    rest = len(groups) - 1 - count
    share = 1.0 - pair.misfit(groups) / max(pair.misfit(together(pair)), 1e-300)
    chance = beta_tail(share, count / 2, rest / 2) if rest > 1 else 1.0
    return chance * comb(len(groups) - 1, count) < _NO_CHANCE


def telling_views(pair: PairAgreement) -> list[int]:
    """Return the places of views that contradict the rest most clearly, the worst first; never none."""
    groups = together(pair)
    gain = _gains(pair, groups)
    usual = POSE * pair.inflation
    order = np.argsort(-gain, kind="stable")
    telling = [int(place) for place in order if gain[place] > _TELLING * usual]
    return telling or [int(order[0])]


def _gains(pair: PairAgreement, groups: Int64[np.ndarray, " n"]) -> Float64[np.ndarray, " n"]:
    """Return the decrease of the misfit by a separate pose for a view, view by view."""
    all_ = pair.misfit(groups)
    return np.array([all_ - pair.misfit(_alone(groups, place)) for place in range(len(groups))])


def _chance_of_view(pair: PairAgreement, gain: float) -> float:
    """Return the probability that one view fits so badly by chance."""
    return f_tail(gain / POSE / pair.inflation, POSE, max(pair.smooth.freedom, 1.0))


def _alone(groups: Int64[np.ndarray, " n"], place: int) -> Int64[np.ndarray, " n"]:
    """Return a grouping with one view in a group of its own."""
    changed = groups.copy()
    changed[place] = groups.max() + 1
    return changed


def _split(pair: PairAgreement, groups: Int64[np.ndarray, " n"]) -> Int64[np.ndarray, " n"]:
    """Return a grouping with one more move, where it explains most."""
    later = np.arange(len(groups))
    inside = np.flatnonzero(np.diff(groups) == 0) + 1
    tried = [groups + (later >= place) for place in inside]
    if not tried:
        return groups
    return tried[int(np.argmin([pair.misfit(one) for one in tried]))]
