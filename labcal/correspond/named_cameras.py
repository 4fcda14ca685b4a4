"""Cameras in the names of loose pictures: two cameras are never silently taken for one.

A name is split into parts: folders, words, numbers, dates and times, what stands between. Pictures of
several cameras differ in one part that takes every value in every view; those of one camera count on.
"""

import re
from collections import Counter, defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path

from labcal.correspond.camera_called import NAMING, SERIAL_DIGITS, cameras_called, may_be_device
from labcal.correspond.camera_folders import camera_folders, equal_folders
from labcal.correspond.cameras_in_turn import cameras_in_turn, order_option
from labcal.correspond.glued_numbers import glued_cameras
from labcal.correspond.name_patterns import ANY, NameParts, best_pattern, name_parts, view_in
from labcal.correspond.natural_order import in_order

_SIDES = ({"left", "right"}, {"l", "r"}, {"links", "rechts"}, {"gauche", "droite"}, {"lft", "rgt"})
_CAMERA = {"cam", "cams", "camera", "cameras", "kamera", "sensor", "eye"}
_NO_CAMERA = {
    "x", "y", "z", "row", "col", "column", "tilt", "pan", "yaw", "pitch", "roll", "angle", "deg", "pos",
    "position", "view", "pose", "frame", "img", "image", "pic", "picture", "photo", "shot", "set", "series",
    "session", "take", "run", "day", "exp", "exposure", "gain", "part", "plane", "height",
}  # fmt: skip
"""Words before a number that does not count cameras."""
_START = re.compile(r"[\W\d_].*")
"""All of a folder's name behind the word that it begins with."""
_MOST_CAMERAS, _MOST_NAMED = 8, 64
"""Cameras that parts of names may tell, unless they are called so; and as many if they are.

Where the rest of the name is called a view or the like, there may be as many cameras as views.
"""
_FULL, _FULL_VIEWS, _MANY_VIEWS = 0.8, 3, 5
"""Share of pictures, and whole views, from which on some may be missing where a single digit or letter at the
end of the names is the camera's; and whole views where a folder, a word or the number of a device is."""
_BY_CHANCE = 0.2
"""Share of views with pictures of all cameras up to which moments are equal by chance."""


@dataclass(frozen=True)
class NamedCameras:
    """Cameras that occur in names of pictures.

    Attributes
    ----------
    option : str or None
        What tells them apart, as ``--cameras`` takes it; None where the names give the views no name.
    pictures : tuple of str
        One picture of every camera.
    """

    option: str | None
    pictures: tuple[str, ...]

    def words(self) -> str:
        """Return a message on the form of the names, with advice."""
        first, *others = (Path(picture) for picture in self.pictures)
        shown = [str(Path(path.parent.name) / path.name) for path in (first, *others)]
        apart = (
            "Name the views, too, as in left1.png and right1.png"
            if self.option is None
            else f"Distinguish them: `cameras='{self.option}'`"
        )
        return (
            f"The pictures' names are those of {len(shown)} cameras ({', '.join(shown)} ...), and cameras "
            f"measured as one give wrong numbers. {apart}; or state that one camera took them all: "
            f"`cameras='{ANY}=camera'`."
        )


def named_cameras(images: Sequence[str]) -> NamedCameras | None:
    """Return the cameras in the names of pictures; None if there may be only one.

    Names tell of cameras where they differ in a side (left and right) or in the number or letter of what is
    called a camera, or where one part of them takes two values or more and crosses completely with the rest;
    or where folders hold equally many pictures, which then pair up in their order.
    """
    alike: dict[tuple[str, ...], list[NameParts]] = defaultdict(list)
    for name in name_parts(images):
        alike[name.kinds].append(name)
    for kinds, splits in sorted(alike.items(), key=lambda item: -len(item[1])):
        if found := _Names(kinds, tuple(splits)).cameras():
            return found
    others = camera_folders(images) or glued_cameras(images)
    return None if others is None else NamedCameras(*others)


@dataclass(frozen=True)
class _Names:
    """Pictures whose names are built alike."""

    kinds: tuple[str, ...]
    splits: tuple[NameParts, ...]

    def cameras(self) -> NamedCameras | None:
        """Return the cameras in these names."""
        candidates = [places for places in self._together() if self._tells(places)]
        in_turn = None if candidates else cameras_in_turn(self.splits)
        if not candidates and in_turn is None:
            return None
        places = in_turn or min(candidates, key=self._doubt)
        pairs = self._pairs(places)
        folders = None if pairs else equal_folders([split.image for split in self.splits])
        if folders is not None:
            return NamedCameras(*folders)
        values = self._values(places)
        pictures = [
            next(split.image for split in self.splits if self._at(split, places) == value) for value in values
        ]
        ordered = None if pairs else order_option(self.splits, places)
        return NamedCameras(ordered or self._option(places), tuple(pictures))

    def _doubt(self, places: tuple[int, ...]) -> tuple[bool, int, bool, int, int]:
        """Return a sort key of places: the place that most likely names the camera is first.

        Cameras are fewer than views, have folders rather than views have, and are counted with fewer digits.
        """
        values = self._values(places)
        in_folder = any(self.kinds[place] == "folder" for place in places)
        longest = max(len(text) for value in values for text in value)
        return (not self._is_named(places), len(values), not in_folder, longest, -places[-1])

    def _together(self) -> list[tuple[int, ...]]:
        """Return the places at which names differ; those that change together in one."""
        changing: dict[tuple[int, ...], list[int]] = defaultdict(list)
        for place in range(len(self.kinds)):
            texts = [split.parts[place] for split in self.splits]
            order = {text: number for number, text in enumerate(dict.fromkeys(texts))}
            if len(order) > 1:
                changing[tuple(order[text] for text in texts)].append(place)
        return [tuple(places) for places in changing.values()]

    def _at(self, split: NameParts, places: Sequence[int]) -> tuple[str, ...]:
        return tuple(split.parts[place] for place in places)

    def _rest(self, places: Sequence[int]) -> list[int]:
        """Return all other places: where names differ there, they tell the view."""
        return [place for place in range(len(self.kinds)) if place not in places]

    def _values(self, places: tuple[int, ...]) -> list[tuple[str, ...]]:
        return sorted({self._at(split, places) for split in self.splits}, key=in_order)

    def _tells(self, places: tuple[int, ...]) -> bool:
        """Tell whether the parts at some places name the camera."""
        count = len(self._values(places))
        if count > _MOST_NAMED:
            return False
        rest = self._rest(places)
        views = len({self._at(split, rest) for split in self.splits})
        few = count <= (max(_MOST_CAMERAS, views) if any(map(self._is_view, rest)) else _MOST_CAMERAS)
        return self._is_named(places) or (few and self._may_number(places) and self._crosses(places))

    def _is_named(self, places: tuple[int, ...]) -> bool:
        """Tell whether the parts are sides, or numbers or letters of what is called a camera."""
        often = Counter(self._at(split, places) for split in self.splits)
        for place in places:
            texts = {split.parts[place].casefold() for split in self.splits}
            common = _common_start(texts)
            if any(_without(start, texts) in _SIDES for start in ("", common)):
                return True
            before = {common.rstrip("-_ .0"), self._word_before(place)}
            if before & _CAMERA and min(often.values()) > 1 and self.kinds[place] != "moment":
                return True
        return False

    def _word_before(self, place: int) -> str:
        """Return the word that stands before a part, where it is the same in all names.

        A folder's is the one that it begins with: ``pose`` of ``pose1`` and ``pose_2``.
        """
        if self.kinds[place] == "folder":
            starts = {_START.sub("", split.parts[place]).casefold() for split in self.splits}
            return starts.pop() if len(starts) == 1 else ""
        before = place - 1
        if before >= 0 and self.kinds[before] == "between":
            before -= 1
        if before < 0 or self.kinds[before] != "word":
            return ""
        words = {split.parts[before].casefold() for split in self.splits}
        return words.pop() if len(words) == 1 else ""

    def _may_number(self, places: tuple[int, ...]) -> bool:
        """Tell whether the parts could be what cameras are called: not a time, an exposure or a row."""
        return any(self.kinds[place] in NAMING and not self._is_view(place) for place in places) or any(
            self.kinds[place] == "number"
            and not self._is_view(place)
            and _counts([split.parts[place] for split in self.splits])
            for place in places
        )

    def _is_view(self, place: int) -> bool:
        """Tell whether a folder or a number is called a view, a position or the like."""
        return self.kinds[place] in ("folder", "number") and self._word_before(place) in _NO_CAMERA

    def _crosses(self, places: tuple[int, ...]) -> bool:
        """Tell whether every view has every camera, or nearly so where the name ends with the camera's.

        Cameras are not more than views, unless the rest of the name is called a view or the like.
        """
        rest = self._rest(places)
        views = Counter(self._at(split, rest) for split in self.splits)
        cameras = len(self._values(places))
        whole = sum(count == cameras for count in views.values())
        if len(views) < (2 if any(map(self._is_view, rest)) else max(2, cameras)):
            return False
        if whole == len(views):
            return True
        last = places[-1] == len(self.kinds) - 1 and all(len(split.parts[-1]) == 1 for split in self.splits)
        likely = any(self._is_serial(place) for place in places) and whole >= _MANY_VIEWS
        nearly = len(self.splits) >= _FULL * cameras * len(views)
        return nearly and (likely or (last and whole >= _FULL_VIEWS))

    def _is_serial(self, place: int) -> bool:
        """Tell whether a part is a folder, a word or the number of a device, not a count."""
        return may_be_device(self.kinds[place], [split.parts[place] for split in self.splits])

    def _pairs(self, places: tuple[int, ...]) -> bool:
        """Tell whether views have pictures of all cameras, and not by chance."""
        rest = self._rest(places)
        views = Counter(self._at(split, rest) for split in self.splits)
        whole = sum(count == len(self._values(places)) for count in views.values())
        return whole > _BY_CHANCE * len(views)

    def _option(self, places: tuple[int, ...]) -> str | None:
        """Return the value of ``--cameras`` that distinguishes the cameras."""
        values = self._values(places)
        for pattern_of in (self._short, self._long):
            called = cameras_called([value[0] for value in values])
            patterns = {pattern_of(value, places): name for value, name in zip(values, called, strict=True)}
            plain = not any(mark in pattern for pattern in patterns for mark in ",=")
            if (
                plain
                and len(set(patterns.values())) == len(values) == len(patterns)
                and self._holds(patterns)
            ):
                return ",".join(f"{pattern}={camera}" for pattern, camera in patterns.items())
        return None

    def _holds(self, patterns: Mapping[str, str]) -> bool:
        """Tell whether patterns give every picture a place of its own, and use all patterns."""
        best = [best_pattern(split.image, patterns) for split in self.splits]
        views = {(p, view_in(s.image, p)) for p, s in zip(best, self.splits, strict=True) if p is not None}
        return len(views) == len(self.splits) and len(set(best)) == len(patterns)

    def _short(self, value: tuple[str, ...], places: tuple[int, ...]) -> str:
        """Return the beginning or the end of the name if it alone gives the camera."""
        first, last = places[0], places[-1]
        if len(self.kinds) == 1:
            return self._long(value, places)
        if len(places) == 1 and last == len(self.kinds) - 1:
            called = self.kinds[max(last - 2, 0) : last] == ("between", "word")
            return (self._constant(last - 2) if called else "") + self._constant(last - 1) + value[0]
        if len(places) == 1 and first == 0:
            return value[0] + (self._constant(1) if self.kinds[1] == "between" else "") + ANY
        return self._long(value, places)

    def _constant(self, place: int) -> str:
        """Return the part at a place if it is the same in all names."""
        if not (0 <= place < len(self.kinds) and self.kinds[place] in ("between", "word")):
            return ""
        texts = {split.parts[place] for split in self.splits}
        return texts.pop() if len(texts) == 1 else ""

    def _long(self, value: tuple[str, ...], places: tuple[int, ...]) -> str:
        """Return the whole name with stars for what changes from view to view."""
        parts = dict(zip(places, value, strict=True))
        texts = []
        for place in range(len(self.kinds)):
            found = {split.parts[place] for split in self.splits}
            texts.append(parts.get(place, next(iter(found)) if len(found) == 1 else ANY))
        return "".join(
            ANY if star else "".join(run) for star, run in groupby(texts, lambda text: text == ANY)
        )


def _common_start(texts: set[str]) -> str:
    """Return the common beginning of texts."""
    first, last = min(texts), max(texts)
    return first[: next((n for n, (a, b) in enumerate(zip(first, last, strict=False)) if a != b), len(first))]


def _without(start: str, texts: set[str]) -> set[str]:
    """Return texts without their common beginning."""
    return {text.removeprefix(start) for text in texts}


def _counts(texts: Sequence[str]) -> bool:
    """Tell whether numbers are 0, 1, 2 ... or 1, 2 ..., or serial numbers."""
    if max(map(len, texts)) >= SERIAL_DIGITS:
        return min(map(len, texts)) >= SERIAL_DIGITS
    values = sorted({int(text) for text in texts})
    return values[0] in (0, 1) and values == list(range(values[0], values[0] + len(values)))
