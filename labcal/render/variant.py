"""The variant of Mitsuba, which is set only while a picture is traced."""

from collections.abc import Iterator
from contextlib import contextmanager
from types import ModuleType
from typing import Any

from labcal.render.llvm import ensure_llvm
from labcal.run.threads import one_drjit_thread

Jit = Any
"""A value of Dr.Jit or Mitsuba; its class is another one in every variant."""
MONO = "llvm_ad_mono"
COLOUR = "llvm_ad_rgb"


@contextmanager
def renderer(variant: str) -> Iterator[ModuleType]:
    """Yield Mitsuba with one variant on one thread, and restore the previous variant afterwards.

    One thread, because a case shall give the same bytes however many cases run beside it; processes spread
    the work.

    Yields
    ------
    module
        Mitsuba.

    Raises
    ------
    DeviceError
        Dr.Jit has no LLVM library to compile with.
    """
    ensure_llvm()
    import mitsuba  # noqa: PLC0415 -- its Dr.Jit must not search for LLVM before ensure_llvm

    before = mitsuba.variant()
    mitsuba.set_variant(variant)
    try:
        with one_drjit_thread():
            yield mitsuba
    finally:
        if before is not None:  # Mitsuba cannot go back to no variant at all
            mitsuba.set_variant(before)
