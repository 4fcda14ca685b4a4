"""The executor of cases in which methods of a user's may run."""

from collections.abc import Iterator, Sequence
from concurrent.futures import Executor
from contextlib import contextmanager

from labcal.run.executor import open_executor, open_pool
from labcal.run.user_code import SEPARATOR


def own_methods(methods: Sequence[str]) -> tuple[str, ...]:
    """Return those of the methods that are a user's."""
    return tuple(name for name in methods if SEPARATOR in name)


@contextmanager
def open_method_executor(workers: int, scheduler: str | None, methods: Sequence[str]) -> Iterator[Executor]:
    """Yield an executor for cases of these methods.

    Methods of a user's run in a process of their own with one worker, too: in this process, a crash of theirs
    would end labcal without a word.

    Parameters
    ----------
    workers : int
    scheduler : str, optional
        As of :func:`~labcal.run.executor.open_executor`.
    methods : sequence of str

    Raises
    ------
    InputError, DeviceError
        As of :func:`~labcal.run.executor.open_executor`.
    """
    if scheduler is None and own_methods(methods):
        with open_pool(workers) as pool:
            yield pool
        return
    with open_executor(workers, scheduler) as executor:
        yield executor
