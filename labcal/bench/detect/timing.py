"""Times of calls on one picture, taken in turn, on one thread."""

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

Call = Callable[[], object]


@dataclass(frozen=True)
class Times:
    """Times of one call in several rounds, shape (rounds,), s.

    Attributes
    ----------
    cpu : ndarray
        Of the processor, in all threads: what else the machine does changes it little.
    wall : ndarray
        Of the clock.
    """

    cpu: np.ndarray
    wall: np.ndarray

    def over(self, other: "Times") -> float:
        """Return the least processor time over that of another call: what disturbs a call makes it longer."""
        return float(self.cpu.min() / other.cpu.min())


def times_in_turn(calls: Sequence[Call], rounds: int) -> list[Times]:
    """Return the times of calls, which are taken in turn so that all meet the machine in the same state."""
    taken = np.zeros((len(calls), rounds, 2))
    for number in range(rounds):
        for which, call in enumerate(calls):
            cpu, wall = time.process_time(), time.perf_counter()
            call()
            taken[which, number] = time.process_time() - cpu, time.perf_counter() - wall
    return [Times(one[:, 0], one[:, 1]) for one in taken]
