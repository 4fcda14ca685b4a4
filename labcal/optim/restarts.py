"""Several starts of one training, of which the best are wanted: who goes on, and who is kept."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from labcal.optim.descent import Descent
from labcal.optim.solution import StopReason

FIRST_MILESTONE = 5
"""Epochs after which runs are compared for the first time (decision "restarts race")."""


@dataclass(frozen=True)
class Race:
    """Runs of a batch that compete in groups, by successive halving.

    At every milestone the worse half of the runs of a group that are still running is given up, but never
    so many that fewer than `keep` are left; once `keep` have reached the goal, so are all others. Jamieson
    and Talwalkar, "Non-stochastic best arm identification and hyperparameter optimization", AISTATS 2016.

    Attributes
    ----------
    groups : sequence of sequence of int
        The numbers of the runs that compete with each other.
    keep : int
        How many of each group are wanted; where it has no more, none is given up.
    first_milestone : int
        Epochs until the first milestone; every doubling of them is another one.
    """

    groups: Sequence[Sequence[int]]
    keep: int = 1
    first_milestone: int = FIRST_MILESTONE

    @classmethod
    def without_losers(cls, count: int) -> "Race":
        """Return the race of so many runs that all go to their own end and are all kept."""
        return cls([range(count)], count)

    def judge(self, runs: Sequence[Descent[Any]], losses: Sequence[float]) -> None:
        """Stop the runs that are given up after this epoch.

        Parameters
        ----------
        runs : sequence of Descent
            All runs of the batch; those that still run have taken equally many epochs.
        losses : sequence of float
            What tells the better ones, one a run: less is better, and NaN is worst.
        """
        for group in self.groups:
            racing = [number for number in group if runs[number].reason is None]
            arrived = sum(runs[number].reason is StopReason.GOAL for number in group)
            if arrived >= self.keep:
                staying = 0
            elif racing and self._is_milestone(runs[racing[0]].epochs):
                staying = max(self.keep, math.ceil(len(racing) / 2))
            else:
                continue
            for number in _ranked(racing, losses)[staying:]:
                runs[number].stop(StopReason.OUTRUN)

    def kept(self, runs: Sequence[Descent[Any]], losses: Sequence[float]) -> list[int]:
        """Return the numbers of the best runs, group by group, in the order that they have there.

        Parameters
        ----------
        runs : sequence of Descent
            All runs of the batch, at their ends.
        losses : sequence of float
            As for :meth:`judge`.
        """
        numbers: list[int] = []
        for group in self.groups:
            ended = [number for number in group if runs[number].reason is not StopReason.OUTRUN]
            best = _ranked(ended, losses)[: self.keep]
            numbers += [number for number in group if number in best]
        return numbers

    def _is_milestone(self, epochs: int) -> bool:
        doublings, rest = divmod(epochs, self.first_milestone)
        return rest == 0 and doublings.bit_count() == 1


def _ranked(numbers: Sequence[int], losses: Sequence[float]) -> list[int]:
    """Return numbers of runs, the best first; of equals, the earlier start."""
    return sorted(numbers, key=lambda number: (math.isnan(losses[number]), losses[number]))
