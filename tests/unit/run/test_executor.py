import os
import time

import pytest

from labcal.errors import InputError
from labcal.run.executor import open_executor


def process_and_square(number: int) -> tuple[int, int]:
    time.sleep(0.05)
    return os.getpid(), number * number


def test_one_worker_runs_here_and_in_order() -> None:
    with open_executor(1) as pool:
        results = list(pool.map(process_and_square, range(4)))
    assert results == [(os.getpid(), number * number) for number in range(4)]


def test_more_workers_are_other_processes() -> None:
    with open_executor(2) as pool:
        results = list(pool.map(process_and_square, range(4)))
    assert [square for _, square in results] == [0, 1, 4, 9]
    assert os.getpid() not in {process for process, _ in results}


@pytest.mark.parametrize("workers", [1, 2])
def test_a_failure_reaches_the_caller(workers: int) -> None:
    with open_executor(workers) as pool:
        future = pool.submit(int, "no number")
        with pytest.raises(ValueError, match="no number"):
            future.result()


def test_no_workers_are_refused() -> None:
    with pytest.raises(InputError, match="at least 1"), open_executor(0):
        pass
