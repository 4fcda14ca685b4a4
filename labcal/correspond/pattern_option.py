"""Patterns, as ``--cameras`` takes them, of cameras that a part of the names tells."""

from itertools import groupby

from labcal.correspond.camera_called import cameras_called
from labcal.correspond.name_patterns import ANY, tells_apart
from labcal.correspond.names_alike import NamesAlike


def pattern_option(names: NamesAlike, places: tuple[int, ...]) -> str | None:
    """Return the value of ``--cameras`` that distinguishes the cameras.

    Parameters
    ----------
    names : NamesAlike
    places : tuple of int
        The parts that tell the camera.

    Returns
    -------
    str or None
        As ``left*=left,right*=right``; None where patterns would have commas or the like, or give no views.
    """
    values = names.values(places)
    images = [split.image for split in names.splits]
    for pattern_of in (_short, _long):
        called = cameras_called([value[0] for value in values])
        patterns = {
            pattern_of(names, value, places): name for value, name in zip(values, called, strict=True)
        }
        plain = not any(mark in pattern for pattern in patterns for mark in ",=")
        if (
            plain
            and len(set(patterns.values())) == len(values) == len(patterns)
            and tells_apart(images, patterns)
        ):
            return ",".join(f"{pattern}={camera}" for pattern, camera in patterns.items())
    return None


def _short(names: NamesAlike, value: tuple[str, ...], places: tuple[int, ...]) -> str:
    """Return the beginning or the end of the name if it alone gives the camera."""
    first, last = places[0], places[-1]
    if len(names.kinds) == 1:
        return _long(names, value, places)
    if len(places) == 1 and last == len(names.kinds) - 1:
        called = names.kinds[max(last - 2, 0) : last] == ("between", "word")
        return (_constant(names, last - 2) if called else "") + _constant(names, last - 1) + value[0]
    if len(places) == 1 and first == 0:
        return value[0] + (_constant(names, 1) if names.kinds[1] == "between" else "") + ANY
    return _long(names, value, places)


def _constant(names: NamesAlike, place: int) -> str:
    """Return the part at a place if it is the same in all names."""
    if not (0 <= place < len(names.kinds) and names.kinds[place] in ("between", "word")):
        return ""
    texts = set(names.texts(place))
    return texts.pop() if len(texts) == 1 else ""


def _long(names: NamesAlike, value: tuple[str, ...], places: tuple[int, ...]) -> str:
    """Return the whole name with stars for what changes from view to view."""
    parts = dict(zip(places, value, strict=True))
    texts = []
    for place in range(len(names.kinds)):
        found = set(names.texts(place))
        texts.append(parts.get(place, next(iter(found)) if len(found) == 1 else ANY))
    return "".join(ANY if star else "".join(run) for star, run in groupby(texts, lambda text: text == ANY))
