"""Names of pictures that are built alike: their parts, and what these are called."""

import re
from collections import Counter, defaultdict
from collections.abc import Sequence
from dataclasses import dataclass

from labcal.correspond.camera_called import NAMING, SERIAL_DIGITS, may_be_device
from labcal.correspond.name_patterns import NameParts
from labcal.correspond.name_words import (
    GRIDS,
    is_date,
    is_dated,
    is_device_word,
    is_picture_word,
    is_placement_word,
    is_quantity,
    is_series_word,
    is_stamp,
    is_time,
    is_unit,
    may_be_placement,
)
from labcal.correspond.natural_order import in_order

_START = re.compile(r"[\W\d_].*")
"""All of a folder's name behind the word that it begins with."""
_MOST_DIGITS = 30
_SURE_DIGITS = 7
"""Of a number, from which on it is rather that of a device than a count."""


@dataclass(frozen=True)
class NamesAlike:
    """Pictures whose names are built alike."""

    kinds: tuple[str, ...]
    splits: tuple[NameParts, ...]

    def together(self) -> list[tuple[int, ...]]:
        """Return the places at which names differ; those that change together in one."""
        changing: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for place in range(len(self.kinds)):
            texts = self.texts(place)
            order = {text: number for number, text in enumerate(dict.fromkeys(texts))}
            if len(order) > 1:
                changing[tuple(order[text] for text in texts)].append(place)
        return [tuple(places) for places in changing.values()]

    def at(self, split: NameParts, places: Sequence[int]) -> tuple[str, ...]:
        """Return the parts of a name at some places."""
        return tuple(split.parts[place] for place in places)

    def texts(self, place: int) -> list[str]:
        """Return the part of every name at a place."""
        return [split.parts[place] for split in self.splits]

    def values(self, places: Sequence[int]) -> list[tuple[str, ...]]:
        """Return the different parts at some places, in order."""
        return sorted({self.at(split, places) for split in self.splits}, key=in_order)

    def rest(self, places: Sequence[int]) -> list[int]:
        """Return all other places: where names differ there, they tell the view."""
        return [place for place in range(len(self.kinds)) if place not in places]

    def views(self, places: Sequence[int]) -> Counter[tuple[str, ...]]:
        """Return the views, as the rest of the names tells them, with their counts of pictures."""
        rest = self.rest(places)
        return Counter(self.at(split, rest) for split in self.splits)

    def word_before(self, place: int) -> str:
        """Return the word that stands before a part, where it is the same in all names.

        A folder's is the one that it begins with: ``pose`` of ``pose1`` and ``pose_2``.
        """
        if self.kinds[place] == "folder":
            return _folder_word(set(self.texts(place)))
        before = place - 1
        if before >= 0 and self.kinds[before] == "between":
            before -= 1
        return self._word(before)

    def _word(self, place: int) -> str:
        """Return the word at a place where it is the same in all names."""
        if not (0 <= place < len(self.kinds) and self.kinds[place] == "word"):
            return ""
        words = set(self.texts(place))
        return words.pop() if len(words) == 1 else ""

    def counts(self, place: int) -> bool:
        """Tell whether numbers are 0, 1, 2 ... or 1, 2 ..."""
        texts = self.texts(place)
        if max(map(len, texts)) > _MOST_DIGITS:
            return False
        values = sorted({int(text) for text in texts})
        return values[0] in (0, 1) and values == list(range(values[0], values[0] + len(values)))

    def is_series(self, place: int) -> bool:
        """Tell whether a folder or a number is called a series, a day, an exposure, a view or the like."""
        if self.kinds[place] == "folder":
            return are_series(set(self.texts(place)))
        if self.kinds[place] != "number":
            return False
        word = self.word_before(place)
        called = is_series_word(word) or is_picture_word(word)
        return called or self._has_unit(place) or self._is_time(place)

    def is_placement(self, place: int) -> bool:
        """Tell whether a folder or a number that differs counts placements of the target."""
        counted = self.kinds[place] in ("folder", "number") and is_placement_word(self.word_before(place))
        return counted and len(set(self.texts(place))) > 1

    def may_be_placement(self, place: int) -> bool:
        """Tell whether a folder or a number that differs may count placements, or pictures of a series."""
        counted = self.kinds[place] in ("folder", "number") and may_be_placement(self.word_before(place))
        return counted and len(set(self.texts(place))) > 1

    def _has_unit(self, place: int) -> bool:
        """Tell whether a unit stands behind a number, as in 20000us, and no further number behind it."""
        behind = "".join(self.kinds[place + 2 : place + 3])
        return behind != "number" and is_unit(self._word(place + 1), counted=self.counts(place))

    def _is_time(self, place: int) -> bool:
        """Tell whether numbers are times of day, behind a date."""
        dated = place > 1 and (self.kinds[place - 2] == "moment" or all(map(is_date, self.texts(place - 2))))
        return dated and all(map(is_time, self.texts(place)))

    def is_date(self, place: int) -> bool:
        """Tell whether numbers are dates, or times since 1970."""
        texts = self.texts(place)
        return self.kinds[place] == "number" and (all(map(is_date, texts)) or all(map(is_stamp, texts)))

    def is_grid(self, place: int) -> bool:
        """Tell whether a number is that of a row or a column, as in r1_c2."""
        if self.kinds[place] != "number":
            return False
        differ = [one for places in self.together() for one in places if self.kinds[one] == "number"]
        words = {self.word_before(one).casefold() for one in differ}
        return any(self.word_before(place).casefold() in grid and grid <= words for grid in GRIDS)

    def is_called_device(self, place: int) -> bool:
        """Tell whether a number stands behind a word for a camera, or for what has one."""
        return self.kinds[place] == "number" and is_device_word(self.word_before(place))

    def is_device(self, place: int) -> bool:
        """Tell whether a part may be a folder, a word or the number of a device, not a count."""
        if self.is_series(place) or self.is_date(place):
            return False
        return may_be_device(self.kinds[place], self.texts(place)) or self.is_called_device(place)

    def is_surely_device(self, place: int) -> bool:
        """Tell whether a part is a folder, or the number or the address of a device, not a count."""
        texts = self.texts(place)
        serial = self.kinds[place] == "number" and min(map(len, texts)) >= _SURE_DIGITS
        serial = serial and not any(text.startswith("0") for text in texts)
        return self.is_device(place) and (serial or self.kinds[place] in ("folder", "serial"))

    def may_number(self, places: Sequence[int]) -> bool:
        """Tell whether parts could be what cameras are called: not a time, an exposure or a row."""
        free = [place for place in places if not (self.is_series(place) or self.is_date(place))]
        return any(
            self.kinds[place] in NAMING
            or (self.kinds[place] == "number" and not self.is_grid(place) and self._numbers(place))
            for place in free
        )

    def _numbers(self, place: int) -> bool:
        """Tell whether numbers count from 0 or 1, are serial numbers, or stand behind a word for a device."""
        texts = self.texts(place)
        if self.is_called_device(place):
            return True
        if max(map(len, texts)) >= SERIAL_DIGITS:
            return min(map(len, texts)) >= SERIAL_DIGITS and not all(text.endswith("00") for text in texts)
        return self.counts(place)


def are_series(folders: set[str]) -> bool:
    """Tell whether folders are called days, sets, exposures or the like: no cameras."""
    if all(map(is_dated, folders)) or all(map(is_quantity, folders)):
        return True
    return is_series_word(_folder_word(folders)) or is_series_word(common_start(folders))


def _folder_word(folders: set[str]) -> str:
    """Return the word that folders begin with, where it is the same one."""
    starts = {_START.sub("", folder) for folder in folders}
    return starts.pop() if len(starts) == 1 else ""


def common_start(texts: set[str]) -> str:
    """Return the common beginning of texts."""
    first, last = min(texts), max(texts)
    return first[: next((n for n, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), len(first))]
