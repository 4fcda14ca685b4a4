"""Groupings of views that explain why the pose between two cameras was not the same in all of them."""

import numpy as np
from jaxtyping import Int64

from labcal.solve.agreement.pair import PairAgreement

FALSE_ALARMS = 1e-6
"""Chance from which on cameras disagree: of a million good pairs one is accused."""
EXPLAINED = 1e-4
"""Chance from which on views agree with each other, once something explains what they did not."""
_MOST_ODD = 0.2
"""Largest share of views that are odd ones among others."""
_FEWEST = 5
"""Shared views from which on an odd one can be told from the others."""
_VIEWS_A_MOVE = 3
"""How many views there are at least, on average, between moves of a camera."""
_TELLING = 3.0
"""Times the misfit that errors explain, from which on a view is named."""


def together(pair: PairAgreement) -> Int64[np.ndarray, " n"]:
    """Return the grouping in which all views have one pose."""
    return np.zeros(len(pair.poses.views), dtype=np.int64)


def disagrees(pair: PairAgreement, pairs: int = 1) -> bool:
    """Tell whether views contradict each other; `pairs` is how many pairs of cameras are asked."""
    return pair.chance(together(pair)) < FALSE_ALARMS / pairs


def odd_views(pair: PairAgreement) -> list[int]:
    """Return the places of the few views without which all others agree; none where there are no such.

    The first one is found where no other single view would do nearly as well.
    """
    groups = together(pair)
    if len(groups) < _FEWEST:
        return []
    odd: list[int] = []
    while len(odd) < max(1, int(_MOST_ODD * len(groups))):
        rest = [place for place in range(len(groups)) if place not in odd]
        left = [pair.misfit(_alone(groups, place)) for place in rest]
        order = np.argsort(left, kind="stable")
        best, next_best = (rest[order[0]], rest[order[1]])
        if pair.chance(_alone(groups, best)) >= EXPLAINED:
            clear = pair.chance(_alone(groups, next_best)) < FALSE_ALARMS
            return sorted([*odd, best]) if clear else []
        odd.append(best)
        groups = _alone(groups, best)
    return []


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
    """Return the share of what errors do not explain that a grouping does."""
    all_ = together(pair)
    expected = 6.0 * (len(all_) - 1) * pair.inflation
    return (pair.misfit(all_) - pair.misfit(groups)) / max(pair.misfit(all_) - expected, 1e-300)


def telling_views(pair: PairAgreement) -> list[int]:
    """Return the places of views that contradict the rest most clearly, the worst first; never none."""
    groups = together(pair)
    all_ = pair.misfit(groups)
    gain = np.array([all_ - pair.misfit(_alone(groups, place)) for place in range(len(groups))])
    usual = 6.0 * pair.inflation
    order = np.argsort(-gain, kind="stable")
    telling = [int(place) for place in order if gain[place] > _TELLING * usual]
    return telling or [int(order[0])]


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
