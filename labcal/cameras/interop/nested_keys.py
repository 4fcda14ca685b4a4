"""Keys within keys of plain YAML and JSON, as one flat list of keys."""

from collections import Counter
from collections.abc import Iterator, Mapping

_MOST_DEEP, _MOST_LISTED = 6, 16
_OF_A_MATRIX, _SIZE = {"data", "rows", "cols", "dt", "sizes"}, {"width", "height"}
"""Keys of a matrix, which may be a damaged one, and of a size; they are kept as they are."""


def without_nesting(content: Mapping[str, object]) -> dict[str, object]:
    """Return the content with the keys within a key, such as ``left``, as ``left_camera_matrix``.

    A key that occurs in one place only stands there by its own name, too, if the outermost mapping has none
    of that name: ``T`` within ``stereo``.
    """
    found = list(_leaves(content, ()))
    count = Counter(path[-1] for path, _ in found)
    outer = {path[0]: value for path, value in found if len(path) == 1}
    inner = {"_".join(path): value for path, value in found if len(path) > 1}
    single = {path[-1]: value for path, value in found if len(path) > 1 and count[path[-1]] == 1}
    return {**single, **inner, **outer}


def _leaves(content: Mapping[str, object], path: tuple[str, ...]) -> Iterator[tuple[tuple[str, ...], object]]:
    """Return what is no mapping of keys, with the keys that lead to it."""
    for key, value in content.items():
        here = (*path, str(key))
        inside = value
        if isinstance(value, list) and value and all(isinstance(one, dict) for one in value[:_MOST_LISTED]):
            inside = {str(number): one for number, one in enumerate(value[:_MOST_LISTED])}
        if _is_nested(inside) and isinstance(inside, dict) and len(path) < _MOST_DEEP:
            yield from _leaves(inside, here)
        else:
            yield here, value


def _is_nested(value: object) -> bool:
    """Tell whether a value is a mapping of keys."""
    return isinstance(value, dict) and bool(value) and not _OF_A_MATRIX & set(value) and set(value) != _SIZE
