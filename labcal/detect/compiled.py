"""Loops over pixels, rays and grid nodes that NumPy cannot express, compiled by Numba."""

import hashlib
import inspect
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar, cast

from numba import njit
from numba.core.dispatcher import Dispatcher

Function = TypeVar("Function", bound=Callable[..., object])


def _digest_of(folder: Path) -> str:
    """Return a digest that changes with any source in a folder or in the folders in it."""
    digest = hashlib.sha256()
    for path in sorted(folder.rglob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


_SOURCES = _digest_of(Path(__file__).parent)
"""Of this package, where all that is compiled lies."""


def compiled(function: Function) -> Function:
    """Return a function as machine code: compiled for its arguments' types when it is first called.

    The code is kept on disk, beside the package or in the user's cache folder, so that this is waited for
    once. Numba sees a change of the function's own file only, but functions call those of other files: the
    name under which the code is kept holds a digest of all of them.
    Sums are taken in the order in which they are written, so that the same input gives the same bytes.

    Parameters
    ----------
    function : callable
        Of numbers and arrays only. Checks of annotations while testing are removed from it: they belong to
        the function that calls it.
    """
    plain = inspect.unwrap(function)
    plain.__qualname__ = f"{plain.__name__}-{_SOURCES}"
    try:
        return cast("Function", _compiler(keep=True)(plain))
    except RuntimeError:  # no folder to keep it in can be written to
        return cast("Function", _compiler(keep=False)(plain))


def is_kept(function: Callable[..., object]) -> bool:
    """Return whether machine code of a compiled function, of these sources, is on disk: nobody waits then."""
    folder = Path(cast("Dispatcher", function).stats.cache_path or "")
    return any(folder.glob(f"*{function.__name__}-{_SOURCES}-*.nbc"))


def _compiler(*, keep: bool) -> Callable[[Callable[..., object]], object]:
    """Return Numba's decorator.

    No liberties with sums: the code that was just compiled and the same code from the disk would use them
    differently, and the bytes would not be the same.
    """
    return njit(cache=keep, nogil=True, error_model="numpy")
