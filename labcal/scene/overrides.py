"""Single values of a description set from the command line: ``cameras.left.focal_px=600``."""

from collections.abc import Callable, Mapping
from typing import Any

from labcal.errors import InputError, UnknownNameError
from labcal.run.yaml_reading import yaml_content
from labcal.wording import clipped

_MOST_LETTERS = 2**16
_MOST_DIGITS = 9

PRESET = ".preset"
"""``photometry.preset=phone`` is ``photometry=phone``: a preset stands for the whole that it fills."""


def apply_overrides(
    content: dict[str, Any],
    overrides: tuple[str, ...],
    written_out: Mapping[str, Callable[[object], object]],
) -> dict[str, Any]:
    """Set values in a complete description.

    Parameters
    ----------
    content : dict
        The description with all its keys, also those that the author left at their defaults; it is changed.
    overrides : tuple of str
        ``key=value`` each: a dotted key (a number picks an entry of a list) and a value in YAML, so that
        ``off`` is false. A later one finds what an earlier one has set.
    written_out : mapping of str to callable
        By dotted key, for what may be given in short (by a name): returns the value with all of its keys, so
        that later overrides find them.

    Returns
    -------
    dict
        `content`.

    Raises
    ------
    UnknownNameError
        There is no such key, or no such name for what may be named; the nearest one is offered.
    InputError
        There is no equals sign, or the value is not YAML.
    """
    for override in overrides:
        key, equals, text = override.partition("=")
        if not equals or not key:
            raise InputError(f"'{clipped(override)}' should read key=value, for example noise=off.")
        if len(text) > _MOST_LETTERS:
            raise InputError(
                f"The value of '{clipped(key)}' has {len(text)} letters. Write a scene's file of your "
                "own instead."
            )
        value = yaml_content(text, f"The value in '{clipped(override)}'")
        key = key.removesuffix(PRESET)
        *path, last = key.split(".")
        node: Any = content
        for depth, part in enumerate(path):
            node = node[_index(node, part, path[:depth])]
        place = _index(node, last, path)
        node[place] = written_out[key](value) if key in written_out else value
    return content


def _index(node: object, part: str, path: list[str]) -> Any:  # noqa: ANN401 -- a key or a position
    """Return the key or index that selects `part` of a node."""
    prefix = "".join(f"{step}." for step in path)
    if isinstance(node, dict):
        if part in node:
            return part
        raise UnknownNameError("key", prefix + part, [prefix + key for key in node])
    if isinstance(node, list):
        if part.isascii() and part.isdecimal() and len(part) <= _MOST_DIGITS and int(part) < len(node):
            return int(part)
        raise UnknownNameError("key", prefix + part, [f"{prefix}{i}" for i in range(len(node))])
    raise InputError(f"'{clipped(prefix.rstrip('.'))}' is a single value and has no key '{clipped(part)}'.")
