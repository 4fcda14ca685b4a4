"""Loops over pixels, rays and grid nodes that NumPy cannot express, compiled by Numba."""

import hashlib
import inspect
import re
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TypeVar, cast

from numba import njit
from numba.core.dispatcher import Dispatcher

Function = TypeVar("Function", bound=Callable[..., object])


_ROOT = Path(__file__).parents[2]
"""The folder that the package lies in."""
_IMPORT = re.compile(r"^(?:from|import) (labcal[\w.]*)", re.MULTILINE)


def _digest_of(path: Path, root: Path = _ROOT) -> str:
    """Return a digest that changes with a source, and with those that it imports, directly or not.

    Of the sources, only those of the package count that lies in `root`. Of a folder they count all.
    """
    found, waiting = {path.resolve()}, [path.resolve()]
    while waiting:
        for module in _imported_by(waiting.pop()):
            place = root.resolve().joinpath(*module.split("."))
            paths = place.rglob("*.py") if place.is_dir() else [place.with_suffix(".py")]
            new = set(paths) - found
            found |= new
            waiting += new
    digest = hashlib.sha256()
    for source in sorted(found):
        digest.update(source.read_bytes())
    return digest.hexdigest()[:12]


@cache
def _imported_by(path: Path) -> tuple[str, ...]:
    """Return the modules of this package that a source imports as it begins."""
    return tuple(_IMPORT.findall(path.read_text(encoding="utf-8")))


def compiled(function: Function) -> Function:
    """Return a function as machine code: compiled for its arguments' types when it is first called.

    The code is kept on disk, beside the package or in the user's cache folder, so that this is waited for
    once. Numba sees a change of the function's own file only, but functions call those of other files: the
    name under which the code is kept holds a digest of its file and of all that this one imports.
    Sums are taken in the order in which they are written, so that the same input gives the same bytes.

    Parameters
    ----------
    function : callable
        Of numbers and arrays only. Checks of annotations while testing are removed from it: they belong to
        the function that calls it.
    """
    plain = inspect.unwrap(function)
    plain.__qualname__ = f"{plain.__name__}-{_digest_of(Path(plain.__code__.co_filename))}"
    try:
        return cast("Function", _compiler(keep=True)(plain))
    except RuntimeError:  # no folder to keep it in can be written to
        return cast("Function", _compiler(keep=False)(plain))


def inlined(function: Function) -> Function:
    """Return a small function whose code is put into that of each compiled function that calls it.

    A call takes some nanoseconds, as much as a small function for every pixel does itself. Otherwise as
    :func:`compiled`.
    """
    return cast("Function", njit(inline="always", error_model="numpy")(inspect.unwrap(function)))


def is_kept(function: Callable[..., object]) -> bool:
    """Return whether machine code of a compiled function, of these sources, is on disk: nobody waits then."""
    folder = Path(cast("Dispatcher", function).stats.cache_path or "")
    return any(folder.glob(f"*{function.__qualname__}-*.nbc"))


def _compiler(*, keep: bool) -> Callable[[Callable[..., object]], object]:
    """Return Numba's decorator.

    No liberties with sums: the code that was just compiled and the same code from the disk would use them
    differently, and the bytes would not be the same.
    """
    return njit(cache=keep, nogil=True, error_model="numpy")
