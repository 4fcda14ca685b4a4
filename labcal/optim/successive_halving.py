"""Successive halving: several initial values of one training, of which the worse are pruned."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from labcal.optim.lm_state import LevenbergMarquardtState
from labcal.optim.stopping import StopReason

FIRST_MILESTONE = 5
"""Epochs after which runs are compared for the first time (Jamieson and Talwalkar 2016)."""


@dataclass(frozen=True)
class SuccessiveHalving:
    """The rule by which runs of a batch are pruned and kept, group by group.

    At every milestone the worse half of the runs of a group that are still running is pruned, but never
    so many that fewer than `keep` are left; once `keep` have reached the goal, all others are pruned.
    Jamieson and Talwalkar, "Non-stochastic best arm identification and hyperparameter optimization", AISTATS
    2016.

    Attributes
    ----------
    groups : sequence of sequence of int
        The indices of the runs that are compared with each other.
    keep : int
        The number of runs wanted from each group; if a group has no more, none is pruned.
    first_milestone : int
        Epochs until the first milestone; every doubling of them is another one.
    """

    groups: Sequence[Sequence[int]]
    keep: int = 1
    first_milestone: int = FIRST_MILESTONE

    @classmethod
    def keeping_all(cls, count: int) -> "SuccessiveHalving":
        """Return the rule that prunes none of `count` runs."""
        return cls([range(count)], count)

    def prune(self, runs: Sequence[LevenbergMarquardtState[Any]], losses: Sequence[float]) -> None:
        """Stop the runs that are pruned after this epoch.

        Parameters
        ----------
        runs : sequence of LevenbergMarquardtState
            All runs of the batch; those that still run have taken equally many epochs.
        losses : sequence of float
            One for each run: less is better, and NaN is worst.
        """
        for group in self.groups:
            running = [number for number in group if runs[number].reason is None]
            arrived = sum(runs[number].reason is StopReason.GOAL for number in group)
            if arrived >= self.keep:
                staying = 0
            elif running and self._is_milestone(runs[running[0]].epochs):
                staying = max(self.keep, math.ceil(len(running) / 2))
            else:
                continue
            for number in _ranked(running, losses)[staying:]:
                runs[number].stop(StopReason.PRUNED)

    def kept(self, runs: Sequence[LevenbergMarquardtState[Any]], losses: Sequence[float]) -> list[int]:
        """Return the indices of the best runs, group by group, in their order within the group.

        Parameters
        ----------
        runs : sequence of LevenbergMarquardtState
            All runs of the batch, at their ends.
        losses : sequence of float
            As for :meth:`prune`.
        """
        numbers: list[int] = []
        for group in self.groups:
            ended = [number for number in group if runs[number].reason is not StopReason.PRUNED]
            best = _ranked(ended, losses)[: self.keep]
            numbers += [number for number in group if number in best]
        return numbers

    def _is_milestone(self, epochs: int) -> bool:
        doublings, rest = divmod(epochs, self.first_milestone)
        return rest == 0 and doublings.bit_count() == 1


def _ranked(numbers: Sequence[int], losses: Sequence[float]) -> list[int]:
    """Return indices of runs, the best first; of equals, the one that is listed first."""
    return sorted(numbers, key=lambda number: (math.isnan(losses[number]), losses[number]))
