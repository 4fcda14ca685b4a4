"""Parts and patterns of picture names; a pattern, as of ``--cameras``, gives camera and view."""

import os
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

ANY = "*"
"""In a pattern: whatever the view is called. Alone it says that all pictures are of one camera."""
_PART = re.compile(
    r"(?P<moment>\d{4}([-_.])\d\d\2\d\d(?:[-_.T ]+\d\d([-_.h]?)\d\d(?:\3\d\d)?)?(?!\d)"
    r"|\d\d([-_.])\d\d\4\d\d(?!\d))"
    r"|(?P<number>\d+)|(?P<word>[^\W\d_]+)|(?P<between>[\W_]+)"
)


@dataclass(frozen=True)
class NameParts:
    """A picture's name in parts, from where the paths of all pictures begin to differ."""

    image: str
    """The path as given."""
    kinds: tuple[str, ...]
    """Of each part: ``folder``, ``word``, ``number``, ``moment`` (a date or time) or ``between``."""
    parts: tuple[str, ...]


def _whole(name: str) -> Path:
    """Return a path from the root on; links stay as they are."""
    return Path(os.path.abspath(name))  # noqa: PTH100


def name_parts(images: Sequence[str]) -> list[NameParts]:
    """Return the parts of every picture's name, without its suffix."""
    paths = [_whole(image) for image in images]
    shared = 0  # folders that all paths begin with
    for together in zip(*(path.parent.parts for path in paths), strict=False):
        if len(set(together)) > 1:
            break
        shared += 1
    found = []
    for image, path in zip(images, paths, strict=True):
        folders, stem = path.parent.parts[shared:], path.stem
        parts = [part for folder in folders for part in (("folder", folder), ("between", "/"))]
        parts += [(str(part.lastgroup), part.group()) for part in _PART.finditer(stem)]
        found.append(NameParts(image, tuple(kind for kind, _ in parts), tuple(text for _, text in parts)))
    return found


def view_in(name: str, pattern: str) -> str | None:
    """Return the view in the name of a picture that fits a pattern, else None.

    Parameters
    ----------
    name : str
        Path of the picture.
    pattern : str
        The end of its name without suffix, or with ``*`` for whatever the view is called: ``left*``,
        ``*_camA_*``; with a slash it is the end of the path: ``LEFT/*``.
    """
    path, stem = _whole(name).parent.as_posix() + "/" + Path(name).stem, Path(name).stem
    if ANY not in pattern:
        return stem.removesuffix(pattern) if stem.endswith(pattern) and stem != pattern else None
    text, start = (path, r"(?:.*/)?") if "/" in pattern else (stem, "")
    found = re.fullmatch(start + "(.*)".join(map(re.escape, pattern.split(ANY))), text)
    view = "" if found is None else "-".join(filter(None, found.groups())).replace("/", "-").strip("-_ .")
    return (stem if pattern == ANY else view) or None


def best_pattern(name: str, patterns: Mapping[str, str]) -> str | None:
    """Return the pattern that fits the name of a picture with most letters of its own, else None."""
    fitting = [pattern for pattern in patterns if view_in(name, pattern) is not None]
    return max(fitting, key=lambda pattern: len(pattern.replace(ANY, "")), default=None)
