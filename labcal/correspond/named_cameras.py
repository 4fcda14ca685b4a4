"""Cameras in the names of loose pictures: two cameras are never silently taken for one.

A name is split into parts: folders, words, numbers, dates and times, what stands between. Pictures of
several cameras differ in one part that takes every value in every view; those of one camera count on.
"""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from labcal.correspond.camera_folders import camera_folders, equal_folders
from labcal.correspond.cameras_apart import cameras_apart
from labcal.correspond.cameras_in_turn import cameras_in_turn, order_option
from labcal.correspond.crossed_names import CrossedNames
from labcal.correspond.glued_numbers import glued_cameras
from labcal.correspond.name_patterns import ANY, NameParts, name_parts, one_camera_pattern
from labcal.correspond.names_alike import NamesAlike
from labcal.correspond.pattern_option import pattern_option
from labcal.wording import listed

_BY_CHANCE = 0.2
"""Share of views with pictures of all cameras up to which moments are equal by chance."""
_SHOWN = 4


@dataclass(frozen=True)
class NamedCameras:
    """Cameras that occur in names of pictures.

    Attributes
    ----------
    option : str or None
        What tells them apart, as ``--cameras`` takes it; None where the names give the views no name.
    pictures : tuple of str
        One picture of every camera.
    alone : str
        The pattern by which all pictures are of one camera.
    """

    option: str | None
    pictures: tuple[str, ...]
    alone: str = ANY

    def words(self) -> str:
        """Return a message on the form of the names, with advice."""
        apart = (
            "Name the views, too, as in left1.png and right1.png"
            if self.option is None
            else f"Distinguish them: `cameras='{self.option}'`"
        )
        return (
            f"The pictures' names are those of {len(self.pictures)} cameras "
            f"({listed(_shown(self.pictures), _SHOWN)} ...), and cameras measured as one give wrong numbers. "
            f"{apart}; or state that one camera took them all: `cameras='{self.alone}=camera'`."
        )


def named_cameras(images: Sequence[str]) -> NamedCameras | None:
    """Return the cameras in the names of pictures; None if there may be only one.

    Names tell of cameras where they differ in a side (left and right) or in the number or letter of what is
    called a camera, or where one part of them takes two values or more and crosses completely with the rest;
    or where folders hold equally many pictures, which then pair up in their order.
    """
    for names in _alike(images):
        crossed = CrossedNames(names)
        places = crossed.called() or cameras_in_turn(names.splits)
        if places is not None:
            partly = len(names.splits) < len(images) and not crossed.is_named(places)
            apart = cameras_apart(images) if partly else None
            option, pictures = apart or _found(names, places)
            return NamedCameras(option, pictures, one_camera_pattern(images))
    others = cameras_apart(images) or camera_folders(images) or glued_cameras(images)
    return None if others is None else NamedCameras(*others, one_camera_pattern(images))


def doubted_cameras(images: Sequence[str]) -> tuple[str | None, tuple[str, ...], int] | None:
    """Return what would distinguish cameras whose numbers may be of something else, and what they are.

    Each of the numbers is in every view, but does not count from 0 or 1, or there are many.

    Returns
    -------
    (str or None, tuple of str, int) or None
        The value of ``--cameras``, the numbers, and their views; None if names have no such numbers.
    """
    for names in _alike(images):
        places = CrossedNames(names).doubted()
        if places is not None:
            values = tuple(value[0] for value in names.values(places))
            return pattern_option(names, places), values, len(names.views(places))
    return None


def _alike(images: Sequence[str]) -> list[NamesAlike]:
    """Return names that are built alike, the most first."""
    alike: dict[tuple[str, ...], list[NameParts]] = defaultdict(list)
    for name in name_parts(images):
        alike[name.kinds].append(name)
    most_first = sorted(alike.items(), key=lambda item: -len(item[1]))
    return [NamesAlike(kinds, tuple(splits)) for kinds, splits in most_first]


def _found(names: NamesAlike, places: tuple[int, ...]) -> tuple[str | None, tuple[str, ...]]:
    """Return what distinguishes the cameras, and a picture of each."""
    pairs = _pairs(names, places)
    folders = None if pairs else equal_folders([split.image for split in names.splits])
    if folders is not None:
        return folders
    pictures = tuple(
        next(split.image for split in names.splits if names.at(split, places) == value)
        for value in names.values(places)
    )
    ordered = None if pairs else order_option(names.splits, places)
    return ordered or pattern_option(names, places), pictures


def _pairs(names: NamesAlike, places: tuple[int, ...]) -> bool:
    """Tell whether views have pictures of all cameras, and not by chance."""
    views, cameras = names.views(places), len(names.values(places))
    whole = sum(count == cameras for count in views.values())
    return whole > _BY_CHANCE * len(views)


def _shown(pictures: Sequence[str]) -> list[str]:
    """Return paths from the folder on in which they begin to differ, at least with that of the picture."""
    parts = [Path(picture).parts for picture in pictures]
    shared = 0
    for together in zip(*parts, strict=False):
        if len(set(together)) > 1:
            break
        shared += 1
    return [str(Path(*one[max(0, min(shared, len(one) - 2)) :])) for one in parts]
