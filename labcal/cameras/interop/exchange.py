"""Data that pass between a rig and the files of other systems."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from enum import Enum
from pathlib import Path

from labcal.cameras.rig import Rig
from labcal.run.file_marks import FileMark


@dataclass(frozen=True)
class SourceText:
    """The text of one file, and where it comes from."""

    path: Path
    text: str
    """Of a file that is no text: a character for each byte (Latin-1)."""
    data: bytes = b""
    """The bytes, for formats that are no text."""

    @property
    def is_text(self) -> bool:
        """False for a file with zero bytes."""
        return b"\0" not in self.data


class Unit(Enum):
    """Unit of the lengths in a file."""

    MILLIMETRES = "mm"
    METRES = "m"

    @property
    def mm(self) -> float:
        """One of them in millimetres."""
        return 1000.0 if self is Unit.METRES else 1.0


@dataclass(frozen=True)
class ReadOptions:
    """Facts that a user gives about files that do not state them."""

    size: tuple[int, int] | None = None
    """Width and height of the pictures, px."""
    unit: Unit | None = None
    lens: str | None = None
    """A lens model of labcal."""
    key: Mapping[str, str] | None = None
    """Names of keys in the files, by the usual ones."""

    @property
    def named(self) -> list[str]:
        """The names of those that are given."""
        return [name for name in ("size", "unit", "lens", "key") if getattr(self, name) is not None]


NOTHING_GIVEN = ReadOptions()


@dataclass(frozen=True)
class ReadRig:
    """A rig from another system's files, in millimetres."""

    rig: Rig
    notes: tuple[str, ...] = ()
    """Notes for people: assumptions and changes."""
    unit: Unit | None = None
    """The unit of lengths that the files themselves state; None where they state none."""


@dataclass(frozen=True)
class OutputText:
    """One file to write."""

    label: str
    """Empty where it holds the whole rig; else the camera's name, or in a folder the file's name."""
    text: str | bytes


@dataclass(frozen=True)
class RigTexts:
    """A rig as the files of another system."""

    files: tuple[OutputText, ...]
    notes: tuple[str, ...] = ()
    """Notes for people: what the files do not state as the rig did."""


class Home(Enum):
    """Place of a format on disk."""

    FILE = "file"
    FOLDER = "folder"


@dataclass(frozen=True)
class RigFormat:
    """The camera files of one other system.

    Its functions raise :class:`labcal.errors.InputError` for what is damaged, and for what one side cannot
    hold.
    """

    name: str
    """On the command line."""
    suffixes: tuple[str, ...]
    """Endings of its files; the first one is written where none is given."""
    home: Home
    most_bytes: int
    """A larger file is not read."""
    recognises: Callable[[str], bool]
    """Returns by a file's text whether it is of this format."""
    read: Callable[[Sequence[SourceText], ReadOptions], ReadRig]
    """Lengths are taken for `unit`."""
    write: Callable[[Rig, str], RigTexts]
    """Takes the rig and the ending of the file to write."""
    mark: FileMark
    """Text by which files that labcal wrote are recognised."""
    unit: Unit = Unit.MILLIMETRES
    """Unit of lengths in its files, if nothing else is known."""
    options: tuple[str, ...] = ("unit",)
    """The :class:`ReadOptions` that reading can make use of."""
    binary: bool = False
    """True if its files are no text."""
    unit_is_usual: bool = True
    """False if its files are in millimetres about as often as in metres."""
