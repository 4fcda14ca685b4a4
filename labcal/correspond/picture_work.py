"""Work on many pictures over an executor, in which one bad picture costs itself alone."""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from typing import TypeVar

import cv2
import numpy as np

from labcal.correspond.sources import Source
from labcal.errors import InputError, InputTypeError, WorkerError
from labcal.run.executor import finished
from labcal.run.progress import Progress

T = TypeVar("T")


def read_and(source: Source, work: Callable[[np.ndarray], T], lost: Callable[[Source, str], T]) -> T:
    """Read a picture and work on it; one that cannot be read, or not be used, is a result with a reason.

    Parameters
    ----------
    source : Source
    work : callable
        From the picture as :meth:`Source.read` returns it to the result.
    lost : callable
        From the source and the reason to the result of a picture that cannot be used.
    """
    try:
        return work(source.read())
    except (InputError, InputTypeError) as error:
        return lost(source, str(error))
    except MemoryError:
        return lost(source, _too_large(source))
    except cv2.error as error:
        if error.code != cv2.Error.StsNoMem:
            raise
        return lost(source, _too_large(source))


def over_pictures(
    executor: Executor,
    work: Callable[..., T],
    cases: Sequence[tuple[Source, *tuple[object, ...]]],
    lost: Callable[[Source, str], T],
    progress: Progress,
) -> list[T]:
    """Return the results of pictures, in their order whatever the order of work.

    A picture that ends each worker process that works on it (it makes a library crash, or takes all memory)
    is a result with a reason: the other pictures are as good as without it.

    Parameters
    ----------
    executor : Executor
    work : callable
        A function of the module level, so that other processes find it.
    cases : sequence of tuple
        Its arguments for each picture, the source first.
    lost : callable
        As of :func:`read_and`.
    progress : Progress
        Advanced by one a picture.
    """
    results: dict[int, T] = {}
    for number, future in finished(executor, work, cases):
        try:
            results[number] = future.result()
        except WorkerError as error:
            source = cases[number][0]
            results[number] = lost(source, _crashed(source, error))
        progress.advance()
    return [results[number] for number in range(len(cases))]


def _too_large(source: Source) -> str:
    return f"The picture {source.image} takes more memory than there is. Scale it down."


def _crashed(source: Source, error: WorkerError) -> str:
    return (
        f"The picture {source.image} ended each process that measured it, the last one with no other beside "
        f"it ({error.how}). Leave it out, or scale it down."
    )
