"""Lenses of the programs for robots, by the words and the named coefficients in their files."""

from collections.abc import Mapping
from pathlib import Path

from labcal.cameras.interop.lens_parameters import fisheye_lens, named_lens, perspective_lens
from labcal.cameras.interop.numbers_text import finite_number
from labcal.cameras.lens import DOUBLE_SPHERE, ENHANCED_UNIFIED, OMNIDIRECTIONAL
from labcal.errors import InputError

Lens = tuple[str, tuple[float, ...]]
_OPENCV_ORDER = ("k1", "k2", "p1", "p2", "k3", "k4", "k5", "k6")
_FISHEYE_ORDER = ("k1", "k2", "k3", "k4")


def numbers_by_name(
    names: tuple[str, ...], content: Mapping[str, object], path: Path, *, prefix: str = ""
) -> list[float]:
    """Return numbers of a mapping in the order of their names.

    Raises
    ------
    InputError
        One is not there, or is no finite number.
    """
    lost = [name for name in names if f"{prefix}{name}" not in content]
    if lost:
        raise InputError(f"{path} has no {prefix}{lost[0]}.")
    return [finite_number(content[f"{prefix}{name}"], f"{prefix}{name}", path) for name in names]


def named_coefficients(
    content: Mapping[str, object], path: Path, least: int = 4, *, prefix: str = ""
) -> list[float]:
    """Return OpenCV's k1 k2 p1 p2 k3 k4 k5 k6 by their names, with 0 for those that are not there.

    Parameters
    ----------
    content : mapping
    path : Path
        The file, for messages.
    least : int
        How many of them must be there, if any is.
    prefix : str
        Of all names.

    Raises
    ------
    InputError
        Some of the first ones are lost, or one is no finite number.
    """
    there = [name for name in _OPENCV_ORDER if f"{prefix}{name}" in content]
    if f"{prefix}k4" in content and f"{prefix}p1" not in content:
        raise InputError(
            f"{path} has {prefix}k4 and no {prefix}p1, as a fisheye has, but does not state that it is one. "
            "State the lens as the program does that reads this file."
        )
    if there:
        numbers_by_name(_OPENCV_ORDER[:least], content, path, prefix=prefix)
    found = [content.get(f"{prefix}{name}", "0") for name in _OPENCV_ORDER]
    return [finite_number(value, name, path) for name, value in zip(_OPENCV_ORDER, found, strict=True)]


def brown(content: Mapping[str, object], path: Path, *, prefix: str = "") -> Lens:
    """Return OpenCV's lens with the coefficients that are named, as of :func:`named_coefficients`."""
    return perspective_lens(named_coefficients(content, path, prefix=prefix))


def rational(content: Mapping[str, object], path: Path) -> Lens:
    """Return OpenCV's lens with k1 to k6, p1 and p2, all of which are there."""
    numbers_by_name(_OPENCV_ORDER, content, path)
    return perspective_lens(named_coefficients(content, path))


def fisheye(
    content: Mapping[str, object],
    path: Path,
    names: tuple[str, ...] = _FISHEYE_ORDER,
    *,
    prefix: str = "",
) -> Lens:
    """Return OpenCV's fisheye, k1 to k4 by the names that they have in the file."""
    return fisheye_lens(numbers_by_name(names, content, path, prefix=prefix))


def double_sphere(content: Mapping[str, object], path: Path) -> Lens:
    """Return the double-sphere lens of xi and alpha."""
    return named_lens(DOUBLE_SPHERE, numbers_by_name(("xi", "alpha"), content, path))


def enhanced_unified(content: Mapping[str, object], path: Path) -> Lens:
    """Return the enhanced unified lens of alpha and beta."""
    return named_lens(ENHANCED_UNIFIED, numbers_by_name(("alpha", "beta"), content, path))


def unified(content: Mapping[str, object], path: Path) -> Lens:
    """Return the unified lens of alpha, which is the enhanced one whose beta is 1."""
    return named_lens(ENHANCED_UNIFIED, (*numbers_by_name(("alpha",), content, path), 1.0))


def omnidirectional(xi: float, content: Mapping[str, object], path: Path) -> Lens:
    """Return the unified lens of Mei and Rives with xi, and k1 k2 p1 p2 behind it."""
    k1, k2, p1, p2, *more = named_coefficients(content, path)
    if any(more):
        raise InputError(f"{path}: a unified lens has k1, k2, p1 and p2 here, but more are there.")
    return named_lens(OMNIDIRECTIONAL, (xi, k1, k2, p1, p2))
