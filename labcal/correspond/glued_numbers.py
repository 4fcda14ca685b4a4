"""Cameras counted by the first or last digit of a number, as in 41.png and 42.png."""

from collections import Counter
from collections.abc import Mapping, Sequence

from labcal.correspond.name_patterns import ANY, NameParts, name_parts

_MOST_DIGITS = 30
_CAMERAS, _LEAST_VIEWS, _PAIR = range(2, 5), 4, 2


def glued_cameras(images: Sequence[str]) -> tuple[str | None, tuple[str, ...]] | None:
    """Return the endings or patterns of cameras counted by one digit of a number, and a picture of each.

    One camera that counts its pictures leaves no such numbers: all of them are there from the first to the
    last, or any may be missing. Here the numbers have gaps, and one digit, which counts from 0 or 1, takes
    every value in every view. Numbers of two digits alone, as 11 to 38, may be rows and columns.

    Parameters
    ----------
    images : sequence of str
        Paths of all pictures.

    Returns
    -------
    (str or None, tuple of str) or None
        As ``1=cam1,2=cam2``, None where names have commas or the like; None if these are no cameras.
    """
    names = name_parts(images)
    place = _counter(names)
    if place is None:
        return None
    numbers = [name.parts[place] for name in names]
    if max(map(len, numbers)) > _MOST_DIGITS:
        return None
    values = sorted({int(number) for number in numbers})
    if len(set(numbers)) < len(images) or values == list(range(values[0], values[0] + len(values))):
        return None
    for last in (-1, 0):
        digits = [number[last] for number in numbers]
        views = [number[:-1] if last else number[1:] for number in numbers]
        surely = max(map(len, views)) > 1 or len(set(digits)) == _PAIR or place > 0
        if surely and _crosses(digits, views):
            pictures: dict[str, str] = {}
            for digit, name in zip(digits, names, strict=True):
                pictures.setdefault(digit, name.image)
            return _option(names[0], place, last, sorted(pictures)), tuple(
                pictures[digit] for digit in sorted(pictures)
            )
    return None


def _counter(names: Sequence[NameParts]) -> int | None:
    """Return the place of the only part in which names differ, if it is a number."""
    if len({name.kinds for name in names}) != 1:
        return None
    differ = [
        place
        for place, texts in enumerate(zip(*(name.parts for name in names), strict=True))
        if len(set(texts)) > 1
    ]
    return differ[0] if len(differ) == 1 and names[0].kinds[differ[0]] == "number" else None


def _crosses(digits: Sequence[str], views: Sequence[str]) -> bool:
    """Tell whether digits count from 0 or 1 and every view has every digit."""
    values = sorted({int(digit) for digit in digits})
    of_view = Counter(views)
    return (
        len(values) in _CAMERAS
        and values[0] in (0, 1)
        and values == list(range(values[0], values[0] + len(values)))
        and len(of_view) >= max(_LEAST_VIEWS, len(values) + 1)
        and set(of_view.values()) == {len(values)}
        and "" not in of_view
    )


def _option(name: NameParts, place: int, last: int, digits: Sequence[str]) -> str | None:
    """Return the value of ``--cameras``: an ending or a pattern for each digit."""
    before, after = "".join(name.parts[:place]), "".join(name.parts[place + 1 :])
    if last and not after:
        forms: Mapping[str, str] = {digit: digit for digit in digits}
    else:
        forms = {
            digit: f"{before}{ANY}{digit}{after}" if last else f"{before}{digit}{ANY}{after}"
            for digit in digits
        }
    plain = not any(mark in form for form in forms.values() for mark in ",={")
    return ",".join(f"{form}=cam{digit}" for digit, form in forms.items()) if plain else None
