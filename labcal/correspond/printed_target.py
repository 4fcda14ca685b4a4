"""The target that pictures show, where nobody names it: read from the code of its print."""

import logging
from collections.abc import Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.correspond.sources import Source
from labcal.errors import InputError
from labcal.run.executor import SerialExecutor
from labcal.run.progress import Progress, progress_of
from labcal.targets.catalogue import AnyTarget, AnyTargets, target_of
from labcal.targets.code_text import PrintedTarget, code_text
from labcal.wording import clipped, counted

if TYPE_CHECKING:
    from labcal.detect.codes.reading import PictureCodes

_LOG = logging.getLogger(__name__)
_NAMED_COPY = "#"


@dataclass(frozen=True)
class ShownTarget:
    """The target that pictures show, and how it is known.

    Attributes
    ----------
    printed : AnyTarget or PrintedTarget
        The target; with its print where its code is what tells it, so that other boards are distinguished.
    picture : str or None
        Path of the picture that it is read from; None where it was given, or a shoot states it.
    notes : tuple of str
        Codes that were passed over, for people.
    """

    printed: AnyTarget | PrintedTarget
    picture: str | None = None
    notes: tuple[str, ...] = ()

    @property
    def target(self) -> AnyTarget:
        """The target as designed."""
        return self.printed.target if isinstance(self.printed, PrintedTarget) else self.printed

    @property
    def words(self) -> tuple[str, ...]:
        """The picture that it is read from, and what was passed over, for people."""
        if self.picture is None or not isinstance(self.printed, PrintedTarget):
            return self.notes
        return (f"the target '{self.printed.name}' is read from the code in {self.picture}", *self.notes)


def named_target(given: AnyTargets | PrintedTarget) -> ShownTarget:
    """Return the target that is given, by itself or by name.

    Parameters
    ----------
    given : AnyTarget, PrintedTarget, path or str
        Of a numbered print, the name of its target with the number: ``"rings-14x10#2"``. Several in a list
        are boards side by side.

    Raises
    ------
    UnknownNameError
        There is no target of that name.
    InputError
        There is no such number.
    """
    if isinstance(given, PrintedTarget):
        return ShownTarget(given)
    if isinstance(given, str) and _NAMED_COPY in given and not Path(given).exists():
        return ShownTarget(_named_print(given))
    return ShownTarget(target_of(given))


def read_target(
    sources: Sequence[Source],
    kept: AnyTarget | None = None,
    executor: Executor | None = None,
    progress: Progress | None = None,
) -> ShownTarget:
    """Return the target that the code of a print tells, and log where it is read.

    Parameters
    ----------
    sources : sequence of Source
        All are searched, so that two prints are noticed.
    kept : AnyTarget, optional
        The target that a rig keeps: taken where no code is read, and where it is one of several prints.
    executor : Executor, optional
    progress : Progress, optional

    Raises
    ------
    InputError
        No picture tells, or they show several prints.
    """
    from labcal.correspond.picture_work import over_pictures  # noqa: PLC0415 -- imports OpenCV

    receiver = progress_of(progress)
    receiver.start("reading codes of prints", len(sources))
    cases = [(source,) for source in sources]
    found = over_pictures(executor or SerialExecutor(), codes_in, cases, _nothing, receiver)
    shown = _only_one([source.image for source in sources], found, kept)
    for words in shown.words:
        _LOG.warning(words)
    return shown


def codes_in(source: Source) -> "PictureCodes":
    """Return the codes in a picture; nothing where it cannot be read, which detection will tell."""
    from labcal.correspond.picture_work import read_and  # noqa: PLC0415 -- imports OpenCV
    from labcal.detect.codes.reading import read_codes  # noqa: PLC0415 -- the same

    return read_and(source, read_codes, _nothing)


def _nothing(_source: Source, _reason: str) -> "PictureCodes":
    from labcal.detect.codes.reading import PictureCodes as Codes  # noqa: PLC0415 -- imports OpenCV

    return Codes()


def _only_one(images: Sequence[str], found: "Sequence[PictureCodes]", kept: AnyTarget | None) -> ShownTarget:
    """Return the one print of all pictures, or the one that is kept, from the first that tells it."""
    seen: dict[str, list[str]] = {}
    prints: dict[str, PrintedTarget] = {}
    for image, codes in zip(images, found, strict=True):
        for printed in codes.prints:
            text = code_text(printed.target, printed.copy)
            prints.setdefault(text, printed)
            seen.setdefault(text, []).append(image)
    notes = _passed_over(images, found)
    if not prints and kept is not None:
        return ShownTarget(kept, notes=notes)
    meant = {text: printed for text, printed in prints.items() if printed.target == kept}
    prints = meant if len(meant) == 1 else prints
    if not prints:
        tags = sum(bool(codes.blocks) for codes in found)
        near = (
            f" Tags of prints are seen in {counted(tags, 'picture')}, their codes are not sharp enough."
            * (tags > 0)
        )
        passed = "".join(f" {note[0].upper()}{note[1:]}." for note in notes)
        raise InputError(
            f"No picture tells which target it shows: no code of a print is read.{near}{passed} Name the "
            "target: `target='NAME'` ('labcal target list' shows the names), or take one sharp picture of "
            "the code."
        )
    if len(prints) > 1:
        raise InputError(
            f"The pictures show {counted(len(prints), 'print')}: {_several(prints, seen)}. Name the one "
            f"whose dots are wanted: `target='{next(iter(prints.values())).name}'`; the others are left out."
        )
    ((text, printed),) = prints.items()
    return ShownTarget(printed, seen[text][0], notes)


def _several(prints: Mapping[str, PrintedTarget], seen: Mapping[str, Sequence[str]]) -> str:
    """Return the prints by name, with where they are seen."""
    parts = [
        f"'{printed.name}' in {counted(len(seen[text]), 'picture')} (first: {seen[text][0]})"
        for text, printed in prints.items()
    ]
    return ", ".join(parts)


def _passed_over(images: Sequence[str], found: "Sequence[PictureCodes]") -> tuple[str, ...]:
    """Return the codes that were passed over, each once, with the picture where it is first seen."""
    notes: dict[str, str] = {}
    for image, codes in zip(images, found, strict=True):
        for text in codes.foreign:
            notes.setdefault(
                f"a QR code that is not labcal's ({clipped(text)!r})", f"in {image} was passed over"
            )
        for reason in codes.refused:
            notes.setdefault(f"the code of a print in {image} is not believed: {reason.rstrip('.')}", "")
    return tuple(f"{what} {where}".rstrip() for what, where in notes.items())


def _named_print(name: str) -> PrintedTarget:
    """Return the print that a name with the number of a copy means."""
    design, _, copy = name.rpartition(_NAMED_COPY)
    if not copy.isascii() or not copy.isdigit():
        raise InputError(
            f"'{clipped(name)}' should be the name of a target and the number of a print of it, as in "
            "'rings-14x10#2'."
        )
    printed = PrintedTarget(target_of(design), int(copy[:9]))
    code_text(printed.target, printed.copy)  # which refuses what no print has
    return printed
