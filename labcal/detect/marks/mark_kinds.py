"""Kinds of marks by name: AprilTags, ArUco markers, coded dots, plain dots."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from labcal.detect.grey import GreyPicture
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.detect.marks.picture_marks import PictureMarks
from labcal.detect.marks.plain_dots import PREFIX, find_plain_dots
from labcal.detect.marks.tags import find_tags, tag_name
from labcal.detect.settings import DetectSettings
from labcal.errors import InputError, UnknownNameError
from labcal.targets.catalogue import load_target, target_names
from labcal.targets.charuco import MarkerDictionary
from labcal.targets.coded_dots import CodedDots
from labcal.targets.ring_codes import RingCode

PLAIN_DOTS = "dots"
"""Name of the kind of plain dots."""


@runtime_checkable  # so that tests can check annotations
class MarkKind(Protocol):
    """A kind of marks that can be looked for in a picture."""

    @property
    def family(self) -> str:
        """First part of the names of its points; two kinds of one family cannot be looked for at once."""

    @property
    def diameter_mm(self) -> float | None:
        """Diameter of its dots, where it is known; None of tags, too."""

    def find(self, grey: GreyPicture, settings: DetectSettings) -> PictureMarks:
        """Return its marks in a picture."""


@dataclass(frozen=True)
class Tags:
    """The tags of a dictionary; a `MarkKind`."""

    dictionary: MarkerDictionary
    diameter_mm: float | None = None
    """None: a tag has corners."""

    @property
    def family(self) -> str:
        """Name of the dictionary."""
        return tag_name(self.dictionary)

    def find(self, grey: GreyPicture, settings: DetectSettings) -> PictureMarks:
        """Return the corners of tags."""
        return find_tags(grey, self.dictionary, settings)


@dataclass(frozen=True)
class CodedMarks:
    """The coded dots of a code, or those of one sheet; a `MarkKind`."""

    code: RingCode
    sheet: CodedDots | None = None

    @property
    def family(self) -> str:
        """Name of the code."""
        return self.code.value

    @property
    def diameter_mm(self) -> float | None:
        """That of the sheet."""
        return None if self.sheet is None else self.sheet.dot_diameter_mm

    def find(self, grey: GreyPicture, settings: DetectSettings) -> PictureMarks:
        """Return coded dots; of a sheet those that it has, and those without a name."""
        found = find_coded_dots(grey, self.code, settings)
        if self.sheet is None:
            return found
        first, last = self.sheet.first_mark, self.sheet.first_mark + self.sheet.count
        number = [int(name.rpartition("-")[2]) if name else first for name in found.point]
        return found.where(np.array([first <= one < last for one in number], dtype=bool))


@dataclass(frozen=True)
class PlainDots:
    """Round dots without a code; a `MarkKind`."""

    diameter_mm: float | None = None

    @property
    def family(self) -> str:
        """First part of the names of plain dots."""
        return PREFIX

    def find(self, grey: GreyPicture, settings: DetectSettings) -> PictureMarks:
        """Return all plain dots."""
        return find_plain_dots(grey, settings)


def mark_names() -> tuple[str, ...]:
    """Return the names of the kinds that need no file: dictionaries of tags, codes of rings, plain dots.

    Sheets of coded dots have names, too, those of their targets.
    """
    return (
        *(tag_name(one) for one in MarkerDictionary),
        *(code.value for code in RingCode),
        PLAIN_DOTS,
    )


def mark_kinds(names: Sequence[str]) -> tuple[MarkKind, ...]:
    """Return kinds of marks by name, plain dots last: what is a part of another mark is none.

    Parameters
    ----------
    names : sequence of str
        Names of :func:`mark_names`, in any case and OpenCV's (``DICT_4X4_50``), too; or targets of coded
        dots, by name or file.

    Raises
    ------
    UnknownNameError
        There is no such kind.
    InputError
        None is named, a target is none of coded dots, or two names are of the same marks.
    """
    kinds = [_kind(name) for name in dict.fromkeys(names)]
    if not kinds:
        raise InputError("No kind of marks is named. Name one: `markers='apriltag-36h11'`.")
    families: dict[str, str] = {}
    for name, kind in zip(dict.fromkeys(names), kinds, strict=True):
        other = families.setdefault(kind.family, name)
        if other != name:
            raise InputError(
                f"'{other}' and '{name}' are both marks of '{kind.family}', whose points would have the same "
                "names. Give one of them in `markers`."
            )
    return tuple(sorted(kinds, key=lambda kind: isinstance(kind, PlainDots)))


def _kind(name: str) -> MarkKind:
    """Return the kind of a name."""
    plain = name.lower().replace("_", "-").removeprefix("dict-")
    for dictionary in MarkerDictionary:
        if plain in (tag_name(dictionary), tag_name(dictionary).removeprefix("aruco-")):
            return Tags(dictionary)
    if plain == PLAIN_DOTS:
        return PlainDots()
    if plain in set(RingCode):
        return CodedMarks(RingCode(plain))
    try:
        target = load_target(name)
    except UnknownNameError:
        sheets = [known for known in target_names() if isinstance(load_target(known), CodedDots)]
        raise UnknownNameError("kind of marks", name, (*mark_names(), *sheets)) from None
    if isinstance(target, CodedDots):
        return CodedMarks(target.code, target)
    raise InputError(
        f"The target '{target.name}' has no marks that are found one by one. `markers` takes "
        f"{', '.join(mark_names()[-3:])}, AprilTags (apriltag-36h11), ArUco markers (aruco-4x4-50) and "
        "targets of coded dots (coded-8x6). Dots of a target are found by 'labcal detect'."
    )
