"""One thread inside, and as many as before afterwards, whatever happens."""

from collections.abc import Callable
from contextlib import AbstractContextManager

import cv2
import pytest
import torch
from threadpoolctl import threadpool_info, threadpool_limits

from labcal.render.llvm import ensure_llvm
from labcal.run.threads import one_blas_thread, one_drjit_thread, one_opencv_thread, one_torch_thread


def drjit_threads(wanted: int | None = None) -> int:
    ensure_llvm()
    import drjit  # noqa: PLC0415 -- only once Dr.Jit was told where LLVM is

    if wanted is not None:
        drjit.set_thread_count(wanted)
    return int(drjit.thread_count())


def blas_threads() -> int:
    return max(library["num_threads"] for library in threadpool_info() if library["user_api"] == "blas")


def fail_in(switch: Callable[[], AbstractContextManager[None]], count: Callable[[], int]) -> None:
    with switch():
        raise RuntimeError(f"{count()} inside")


@pytest.mark.parametrize(
    ("switch", "count", "set_count"),
    [
        (one_opencv_thread, cv2.getNumThreads, cv2.setNumThreads),
        (one_torch_thread, torch.get_num_threads, torch.set_num_threads),
        (one_drjit_thread, drjit_threads, drjit_threads),
    ],
    ids=["opencv", "torch", "drjit"],
)
def test_the_number_of_threads_is_restored_after_an_error(
    switch: Callable[[], AbstractContextManager[None]],
    count: Callable[[], int],
    set_count: Callable[[int], object],
) -> None:
    before = count()
    set_count(2)
    try:
        with pytest.raises(RuntimeError, match="1 inside"):
            fail_in(switch, count)
        assert count() == 2
    finally:
        set_count(before)


def test_blas_has_one_thread_inside_and_two_again_afterwards() -> None:
    with threadpool_limits(limits=2, user_api="blas"):
        with pytest.raises(RuntimeError, match="1 inside"):
            fail_in(one_blas_thread, blas_threads)
        assert blas_threads() == 2
