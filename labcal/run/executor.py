"""How cases are spread: behind ``concurrent.futures.Executor``, in this process or in several."""

from collections.abc import Callable, Iterator
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing import get_context
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
T = TypeVar("T")


class SerialExecutor(Executor):
    """Runs every case at once, in this process."""

    def submit(self, fn: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Run the case and return its finished future."""
        future: Future[T] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:  # noqa: BLE001 -- the future carries it to whoever asks for the result
            future.set_exception(error)
        return future


@contextmanager
def open_executor(workers: int) -> Iterator[Executor]:
    """Give an executor of that many processes; one runs in this process."""
    if workers == 1:
        yield SerialExecutor()
        return
    # 'spawn' on every system: a forked child would inherit the threads of OpenMP and Dr.Jit.
    with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
        yield pool
