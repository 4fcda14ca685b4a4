"""The best methods of a family and strength, over noises, numbers of points and layouts."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from labcal.bench.distortion.network_answer import MARGIN
from labcal.bench.distortion.winners import Winner
from labcal.bench.families.registry import FAMILIES


@dataclass(frozen=True)
class WinnerGroup:
    """The best methods in the cells of a family, strength and region.

    Attributes
    ----------
    known_as : str
        The strength as people know it: a coefficient, degrees, pixels.
    cells : int
        In which a method has a figure.
    won : mapping of str to int
        Cells by their best method, the one with most first.
    over_oracle : (float, float, float)
        RMS error of the best methods over the oracle's: median, least and greatest of the cells.
    lead : (float, float, float)
        Error of the second method over that of the best: median, least and greatest of the cells.
    clear : int
        Cells in which every seed has the same method ahead, and the second errs by more than 5% more.
    """

    family: str
    strength: float
    known_as: str
    cells: int
    won: dict[str, int]
    over_oracle: tuple[float, float, float]
    lead: tuple[float, float, float]
    clear: int


def winner_groups(winners: Sequence[Winner], region: str) -> list[WinnerGroup]:
    """Return the winners of a region by family and strength, in the order of the plan.

    Parameters
    ----------
    winners : sequence of Winner
    region : str
        ``within`` or ``outside``.
    """
    groups: dict[tuple[str, float], list[Winner]] = {}
    for one in winners:
        if one.measured == region:
            groups.setdefault((one.family, one.strength), []).append(one)
    return [_group(group) for group in groups.values()]


def is_clear(winner: Winner) -> bool:
    """Return whether the best method is ahead in every seed, by more than the margin of the answer."""
    return winner.seeds_won == winner.seeds and winner.second_over_best > MARGIN


def _group(group: Sequence[Winner]) -> WinnerGroup:
    known = [one for one in group if one.best is not None]
    first = group[0]
    return WinnerGroup(
        family=first.family,
        strength=first.strength,
        known_as=FAMILIES[first.family].known_as(first.strength),
        cells=len(known),
        won=dict(Counter(one.best for one in known if one.best is not None).most_common()),
        over_oracle=_range([one.over_oracle for one in known]),
        lead=_range([one.second_over_best for one in known]),
        clear=sum(map(is_clear, known)),
    )


def _range(values: Sequence[float]) -> tuple[float, float, float]:
    known = [value for value in values if np.isfinite(value)]
    if not known:
        return (float("nan"),) * 3
    return float(np.median(known)), min(known), max(known)
