"""Switches to one thread for multi-threaded libraries, so that results have the same bytes everywhere."""

import os
import sys
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from functools import lru_cache
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from threadpoolctl import ThreadpoolController

_VARIABLES = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "BLIS_NUM_THREADS")
"""Read by BLAS, OpenMP and torch when they are loaded."""


@contextmanager
def one_thread() -> Iterator[None]:
    """Let every library compute with one thread inside, and with as many as before afterwards.

    Those that are loaded already are set, those that are loaded inside read it from the environment. The
    switch holds for the whole process: two threads must not be in it at the same time.
    """
    with ExitStack() as switches:
        switches.enter_context(_environment_of_one_thread())
        switches.enter_context(_pools(len(sys.modules)).limit(limits=1))
        for library, switch in _SWITCHES.items():
            if library in sys.modules:
                switches.enter_context(switch())
        yield


@contextmanager
def _environment_of_one_thread() -> Iterator[None]:
    """Set the variables that libraries read when they are loaded."""
    before = {name: os.environ.get(name) for name in _VARIABLES}
    os.environ.update(dict.fromkeys(_VARIABLES, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@lru_cache(maxsize=1)
def _pools(modules: int) -> "ThreadpoolController":  # noqa: ARG001 -- only to look again when one was loaded
    """Return the switch of all loaded libraries; to search for them takes milliseconds."""
    from threadpoolctl import ThreadpoolController  # noqa: PLC0415 -- as below

    return ThreadpoolController()


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Let NumPy's and SciPy's BLAS compute with one thread inside, and with as many as before afterwards.

    The matrices here are too small for more. Measured on two cores that others used, too: factoring 200 x 200
    takes ten times as long with two threads as with one. The number of threads also decides on the last
    digits. Only libraries that are loaded when this is called are changed: what computes with SciPy inside
    imports it at the head of its file.
    """
    from threadpoolctl import threadpool_limits  # noqa: PLC0415 -- each switch imports its own library

    with threadpool_limits(limits=1, user_api="blas"):
        yield


@contextmanager
def one_opencv_thread() -> Iterator[None]:
    """Let OpenCV compute with one thread inside, and with as many as before afterwards.

    Its calibration forms sums in the order in which its threads end: with more than one the same points give
    other last digits at every run.
    """
    import cv2  # noqa: PLC0415 -- as above

    before = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        yield
    finally:
        cv2.setNumThreads(before)


@contextmanager
def one_torch_thread() -> Iterator[None]:
    """Let torch compute with one thread inside, and with as many as before afterwards.

    The number of threads decides in which order sums are formed, and with it the last bits of a result.
    """
    import torch  # noqa: PLC0415 -- as above

    before = torch.get_num_threads()
    torch.set_num_threads(1)
    try:
        yield
    finally:
        torch.set_num_threads(before)


@contextmanager
def one_drjit_thread() -> Iterator[None]:
    """Let Dr.Jit, and with it Mitsuba, compute with one thread inside, and with as many as before afterwards.

    A case gives the same bytes, however many cases run at the same time. Dr.Jit has to know where LLVM is.
    """
    import drjit  # noqa: PLC0415 -- as above

    before = drjit.thread_count()
    drjit.set_thread_count(1)
    try:
        yield
    finally:
        drjit.set_thread_count(before)


_SWITCHES = {"cv2": one_opencv_thread, "torch": one_torch_thread}
"""Switches of libraries with threads of their own, by the name of the module; Dr.Jit's is the renderer's."""
