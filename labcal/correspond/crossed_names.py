"""Parts of names that tell cameras since they are called so, or take every value in every view."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from labcal.cameras.sides import are_sides, words_in
from labcal.correspond.name_words import is_camera_word
from labcal.correspond.names_alike import NamesAlike, common_start

_MOST_CAMERAS, _MOST_NAMED = 8, 64
"""Cameras that parts of names may tell, unless they are called so; and as many if they are.

Where the rest of the name is called a view or the like, there may be as many cameras as views.
"""
_LEAST_VIEWS = 2
_FULL, _FULL_VIEWS, _MANY_VIEWS = 0.8, 3, 5
"""Share of pictures, and whole views, from which on some may be missing where a single digit or letter at the
end of the names is the camera's; and whole views where a folder, a word or the number of a device is."""
_PADDED = 3
"""Digits of a number that begins with zeros, from which on it counts views rather than cameras."""


@dataclass(frozen=True)
class CrossedNames:
    """Names that are built alike, and the parts of them that are the cameras'."""

    names: NamesAlike

    def called(self) -> tuple[int, ...] | None:
        """Return the places that tell the camera; None if there are none."""
        candidates = [places for places in self.names.together() if self._tells(places)]
        if not candidates:
            return None
        best = min(candidates, key=self._doubt)
        return self._device_beside(best) or best

    def doubted(self) -> tuple[int, ...] | None:
        """Return the places of numbers that may be of cameras, or of something else, with every view."""
        names = self.names
        candidates = []
        for places in names.together():
            numbers = any(names.kinds[place] == "number" for place in places)
            few = 1 < len(names.values(places)) <= _MOST_NAMED
            if numbers and few and not any(map(names.is_series, places)):
                placed = any(map(names.may_be_placement, names.rest(places)))
                least = _FULL_VIEWS if placed else max(_FULL_VIEWS, len(names.values(places)))
                candidates += [places] if self._crosses(places, least, sure=True) else []
        return min(candidates, key=self._doubt, default=None)

    def _doubt(self, places: tuple[int, ...]) -> tuple[bool, int, bool, bool, int, int]:
        """Return a sort key of places: the place that most likely names the camera is first.

        Cameras are fewer than views, have folders rather than views have, and are counted with fewer digits.
        """
        values = self.names.values(places)
        in_folder = any(self.names.kinds[place] == "folder" for place in places)
        device = any(map(self.names.is_surely_device, places))
        longest = max(len(text) for value in values for text in value)
        return (not self.is_named(places), len(values), not in_folder, not device, longest, -places[-1])

    def _device_beside(self, places: tuple[int, ...]) -> tuple[int, ...] | None:
        """Return the only other places that differ, of more devices than views, where 000, 001 are found."""
        names = self.names
        others = [other for other in names.together() if other != places]
        texts = [text for place in places for text in names.texts(place)]
        padded = len(places) == 1 and names.kinds[places[0]] == "number" and not self.is_named(places)
        if not padded or min(map(len, texts)) < _PADDED or min(texts)[0] != "0" or len(others) != 1:
            return None
        device = any(map(names.is_surely_device, others[0])) and len(names.values(others[0])) <= _MOST_NAMED
        return others[0] if device else None

    def _tells(self, places: tuple[int, ...]) -> bool:
        """Tell whether the parts at some places name the camera."""
        names = self.names
        count = len(names.values(places))
        if count > _MOST_NAMED:
            return False
        if self.is_named(places):
            return True
        if not names.may_number(places):
            return False
        sure = any(names.is_surely_device(place) or names.is_called_device(place) for place in places)
        placed = any(map(names.is_placement, names.rest(places)))
        most = _MOST_NAMED if sure else max(_MOST_CAMERAS, len(names.views(places)) if placed else 0)
        least = _LEAST_VIEWS if placed else max(_LEAST_VIEWS, count)
        return count <= most and self._crosses(places, least, sure=any(map(names.is_device, places)))

    def is_named(self, places: Sequence[int]) -> bool:
        """Tell whether the parts are sides, or numbers or letters of what is called a camera."""
        names = self.names
        often = Counter(names.at(split, places) for split in names.splits)
        for place in places:
            texts = set(names.texts(place))
            if called_sides(texts):
                return True
            before = (common_start(texts).rstrip("-_ .0"), names.word_before(place))
            counted = min(often.values()) > 1 and names.kinds[place] != "moment"
            free = not (names.is_series(place) or names.is_date(place))
            if counted and free and any(map(is_camera_word, before)):
                return True
        return False

    def _crosses(self, places: tuple[int, ...], least: int, *, sure: bool) -> bool:
        """Tell whether every view has every camera, or nearly so where the parts surely are a camera's.

        So they are where the names end with them, too. There are at least `least` views.
        """
        names = self.names
        views, cameras = names.views(places), len(names.values(places))
        whole = sum(count == cameras for count in views.values())
        if len(views) < least:
            return False
        if whole == len(views):
            return True
        end = len(names.kinds) - 1
        last = places[-1] == end and all(len(text) == 1 for text in names.texts(end))
        nearly = len(names.splits) >= _FULL * cameras * len(views)
        return nearly and ((sure and whole >= _MANY_VIEWS) or (last and whole >= _FULL_VIEWS))


def called_sides(texts: set[str]) -> bool:
    """Tell whether two texts differ in a left and a right: ``left`` and ``right``, ``imgL`` and ``imgR``."""
    start = common_start({text.casefold() for text in texts})
    if are_sides(texts) or are_sides({text.casefold().removeprefix(start) for text in texts}):
        return True
    if len(texts) != 2:  # noqa: PLR2004 -- a pair
        return False
    one, two = (Counter(words_in(text)) for text in sorted(texts))
    return are_sides({*(one - two), *(two - one)})
