"""The version of the code that computes: labcal's number, and a digest of its sources."""

import hashlib
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from importlib.resources.abc import Traversable
from importlib.util import find_spec
from pathlib import Path

from labcal.version import __version__


@dataclass(frozen=True)
class CodeVersion:
    """The version of labcal's code."""

    version: str
    sha256: str
    """Of all of its Python files, so that a source tree with changes is a version of its own."""

    def __str__(self) -> str:
        return f"labcal {self.version} (code {self.sha256[:8]})"


@cache
def code_version() -> CodeVersion:
    """Return the version of the code that is running; it is computed once a process."""
    digest = hashlib.sha256()
    for name, source in _sources(files("labcal"), "labcal"):
        digest.update(f"{name}\0".encode())
        digest.update(hashlib.sha256(source).digest())
    return CodeVersion(__version__, digest.hexdigest())


def _sources(folder: Traversable, path: str) -> Iterator[tuple[str, bytes]]:
    """Yield the Python files below a folder in the order of their names, each with its content."""
    for entry in sorted(folder.iterdir(), key=lambda entry: entry.name):
        name = f"{path}/{entry.name}"
        if entry.name.endswith(".py"):
            yield name, entry.read_bytes()
        elif entry.is_dir() and entry.name != "__pycache__":
            yield from _sources(entry, name)


@cache
def module_digest(module: str) -> str:
    """Return the SHA-256 of a module outside labcal, for cases whose result depends on it.

    The digest is that of its file when it is first asked for in this process.

    Parameters
    ----------
    module : str
        The full name, which can be imported.

    Returns
    -------
    str
        Hexadecimal digits; empty for a module without a file of its own, such as one that is built in.
    """
    loaded = sys.modules.get(module)
    origin = getattr(loaded, "__file__", None)
    if loaded is None:
        found = find_spec(module)
        origin = None if found is None else found.origin
    if origin is None or not Path(origin).is_file():
        return ""
    return hashlib.sha256(Path(origin).read_bytes()).hexdigest()
