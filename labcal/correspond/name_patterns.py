"""Parts and patterns of picture names; a pattern, as of ``--cameras``, gives camera and view."""

import os
import re
from collections.abc import Collection, Iterable, Sequence
from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

ANY = "*"
"""In a pattern: whatever the view is called. Alone it says that all pictures are of one camera."""
VIEW, CAMERA = "{view}", "{camera}"
"""In a pattern: the view, as ``*``, and the name of the camera."""
_MOST_LEVELS = 8
"""Folders in which pictures of one name may lie."""
_TOKEN = re.compile(r"(\*|\{view\}|\{camera\})")
_ACCENTS = "\u0300-\u036f"
"""Signs behind their letters, as macOS writes them."""
_PART = re.compile(
    r"(?P<moment>\d{4}([-_.])\d\d\2\d\d(?:[-_.T ]+\d\d([-_.h]?)\d\d(?:\3\d\d)?)?(?!\d)"
    r"|\d\d([-_.])\d\d\4\d\d(?!\d)|[0-3]\d([-.])[0-3]\d\5(?:19|20)\d\d(?!\d))"
    r"|(?P<serial>(?<![^\W_])(?:(?=\d*[A-Fa-f])(?=[A-Fa-f]*\d)[\dA-Fa-f]{7,}(?![^\W_])"
    r"|(?:192([-_.])168\7\d{1,3}\7|(?:10|172)(?:\.\d{1,3}){2}\.)\d{1,3}(?!\d)))"
    rf"|(?P<number>\d+)|(?P<word>[^\W\d_](?:[^\W\d_]|[{_ACCENTS}])*)|(?P<between>[\W_]+)"
)


@dataclass(frozen=True)
class NameParts:
    """A picture's name in parts, from where the paths of all pictures begin to differ."""

    image: str
    """The path as given."""
    kinds: tuple[str, ...]
    """Of each part: ``folder``, ``word``, ``number``, ``serial``, ``moment`` (a date or time) or ``between``.

    A ``serial`` has digits and the letters A to F, as in DEV_000F314B1E58, or is an address, as
    192.168.0.10: the number of a device.
    """
    parts: tuple[str, ...]


def _whole(name: str) -> Path:
    """Return a path from the root on; links stay as they are."""
    return Path(os.path.abspath(name))  # noqa: PTH100


def name_parts(images: Sequence[str]) -> list[NameParts]:
    """Return the parts of every picture's name, without its suffix."""
    return list(_parts_of(tuple(images), Path.cwd()))


@lru_cache(maxsize=2)
def _parts_of(images: tuple[str, ...], _home: Path) -> tuple[NameParts, ...]:
    """Return the parts of names, kept for those who ask for them next."""
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
    return tuple(found)


def view_in(name: str, pattern: str) -> str | None:
    """Return the view in the name of a picture that fits a pattern, else None.

    Parameters
    ----------
    name : str
        Path of the picture.
    pattern : str
        The end of its name, with its suffix or without, or with ``*`` for whatever the view is called:
        ``left*``, ``*_camA_*``; with a slash it is the end of the path: ``LEFT/*``. ``{view}`` is the same as
        ``*``, and ``{camera}`` stands for what the camera is called.
    """
    found = _fitted(name, pattern)
    return None if found is None else found[1]


def camera_in(name: str, pattern: str, camera: str) -> str:
    """Return the camera of a picture that fits a pattern: the text at ``{camera}``, else the one given.

    Parameters
    ----------
    name : str
        Path of the picture.
    pattern : str
        As of :func:`view_in`.
    camera : str
        The camera of the pattern.
    """
    found = _fitted(name, pattern)
    return camera if found is None or camera != CAMERA else found[0]


def _fitted(name: str, pattern: str) -> tuple[str, str] | None:
    """Return the texts at ``{camera}`` (empty without it) and at the view; None if the name does not fit."""
    stem, ending = Path(name).stem, Path(name).suffix
    if len(ending) > 1 and pattern.endswith(ending) and pattern != ending:
        pattern = pattern.removesuffix(ending)  # as typed for a file: cam1_*.png
    if not _TOKEN.search(pattern):
        fits = stem.endswith(pattern) and stem != pattern
        return ("", stem.removesuffix(pattern)) if fits else None
    if pattern == ANY:
        return "", stem
    within_path = "/" in pattern
    text, start = (f"{_whole(name).parent.as_posix()}/{stem}", r"(?:.*/)?") if within_path else (stem, "")
    pieces = _TOKEN.split(pattern)
    tokens = pieces[1::2]
    within = ["([^/]+)" if token == CAMERA else "(.*)" for token in tokens]
    form = start + re.escape(pieces[0])
    form += "".join(group + re.escape(fixed) for group, fixed in zip(within, pieces[2::2], strict=True))
    found = re.fullmatch(form, text)
    if found is None:
        return None
    texts = list(zip(tokens, found.groups(), strict=True))
    camera = next((part for token, part in texts if token == CAMERA), "")
    view = "-".join(part for token, part in texts if token != CAMERA and part).replace("/", "-").strip("-_ .")
    return (camera, view) if view else None


def one_camera_pattern(images: Sequence[str]) -> str:
    """Return the pattern by which all pictures are of one camera, as ``*``; ``*/*`` where names are twice."""
    forms = ("/".join([ANY] * levels) for levels in range(1, _MOST_LEVELS))
    alone = (form for form in forms if tells_apart(images, [form]))
    return next(alone, ANY)


def tells_apart(images: Sequence[str], patterns: Collection[str]) -> bool:
    """Tell whether patterns give every picture a place of its own, and all of them are used."""
    best = [best_pattern(image, patterns) for image in images]
    views = {(p, view_in(image, p)) for p, image in zip(best, images, strict=True) if p is not None}
    return len(views) == len(images) and len(set(best)) == len(patterns)


def best_pattern(name: str, patterns: Iterable[str]) -> str | None:
    """Return the pattern that fits the name of a picture with most letters of its own, else None."""
    fitting = [pattern for pattern in patterns if view_in(name, pattern) is not None]
    return max(fitting, key=lambda pattern: len(_TOKEN.sub("", pattern)), default=None)
