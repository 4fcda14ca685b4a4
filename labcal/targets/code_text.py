"""The text in a print's QR code: the whole description of its target, short, with a checksum.

All letters are of the QR code's alphanumeric mode (ISO/IEC 18004, table 5), which takes 5.5 bits each:

    LABCAL1:D:RINGS-10X8:10X8:S:3.5:3.5:1.4:1.4:0.55:2.2.7.5:B:3.5:0:K4J0ZX

These are the version, the kind, the target's name, what the kind has (:mod:`labcal.targets.code_fields`),
the number of the copy, and the checksum of all that stands before it.
"""

import re
import zlib
from dataclasses import dataclass

from pydantic import ValidationError

from labcal.errors import InputError
from labcal.run.names import is_name
from labcal.targets.catalogue import AnyTarget, load_target, target_names
from labcal.targets.code_fields import FORMS, form_of
from labcal.wording import clipped, shown

VERSION = 1
MOST_LETTERS = 154
"""In a QR code of version 6 with error correction M; longer texts would be too fine to be read."""
MOST_COPIES = 9999
MOST_DOTS = 20_000
"""Dots of a print with a code; no sheet has more that a camera could tell apart."""
MOST_SHEET_MM = 10_000.0
"""Longest side of a print with a code."""
LEAST_PITCH_MM = 0.05
"""Mean distance of dots of a print with a code; no printer does finer ones."""

_BEGINNING = re.compile(r"LABCAL([0-9]{1,4}):")
_DIGITS = "0123456789ABCDEFGHIJKLMNOPQRSTUVWXYZ"
_CHECKSUM_LETTERS = 7  # of base 36, for 32 bits
_CAPITAL = "$"
"""Stands before a letter of a name that is a capital one."""


@dataclass(frozen=True)
class PrintedTarget:
    """The content of a print's code.

    Attributes
    ----------
    target : AnyTarget
        The target that is printed, as designed.
    copy : int
        Number that tells prints of one design apart; 0 where it was left out.

    Examples
    --------
    >>> import labcal
    >>> labcal.PrintedTarget(labcal.load_target("rings-10x8"), 2).name
    'rings-10x8#2'
    """

    target: AnyTarget
    copy: int = 0

    @property
    def name(self) -> str:
        """Name of the print: of its target, with ``#`` and the number of the copy if it has one."""
        return f"{self.target.name}#{self.copy}" if self.copy else self.target.name


def code_text(target: AnyTarget, copy: int = 0) -> str:
    """Return the text that describes a print.

    Parameters
    ----------
    target : AnyTarget
        A target of one of labcal's own kinds.
    copy : int
        Number of the print, where there are several of one design.

    Raises
    ------
    InputError
        The target is of a kind of the user's, too long to be described, or beyond what a printer prints; or
        there is no such copy.
    """
    form = form_of(target)
    if form is None:
        raise InputError(
            f"'{clipped(target.name)}' is of a kind of your own, which a code cannot describe. Print it "
            "plain (`copy=None`), and name it: `target='NAME'`."
        )
    if not 0 <= copy <= MOST_COPIES:
        raise InputError(f"A copy has a number from 1 to {MOST_COPIES}, but {shown(copy)} was given.")
    _require_printable(target)
    fields = [f"LABCAL{VERSION}", form.letter, _encoded_name(target.name), *form.fields(target), str(copy)]
    text = ":".join(fields)
    text = f"{text}:{_checksum(text)}"
    if len(text) > MOST_LETTERS:
        raise InputError(
            f"The description of '{clipped(target.name)}' takes {len(text)} letters, and a code holds "
            f"{MOST_LETTERS}: give it a shorter name, or lengths with fewer digits, or print it plain "
            "(`copy=None`)."
        )
    return text


def described_by(text: str) -> PrintedTarget | None:
    """Return the target that a text in a QR code describes; None for a code that is none of labcal's.

    Parameters
    ----------
    text : str
        What a QR code says; it need not be true.

    Returns
    -------
    PrintedTarget or None
        The target, which is the shipped one where it is the same.

    Raises
    ------
    InputError
        It claims to be a description, and is none: another version, a wrong checksum, or values that no
        target has.
    """
    beginning = _BEGINNING.match(text[:16])
    if beginning is None:
        return None
    if int(beginning[1]) != VERSION:
        raise InputError(
            f"It is of version {int(beginning[1])}, and this labcal reads version {VERSION}. Update labcal, "
            "or name the target: `target='NAME'`."
        )
    if len(text) > MOST_LETTERS:
        raise InputError(f"It has {len(text)} letters, more than the {MOST_LETTERS} of a description.")
    body, _, checksum = text.rpartition(":")
    if checksum != _checksum(body):
        raise InputError(f"Its checksum is {clipped(checksum)!r}, but should be '{_checksum(body)}'.")
    _, letter, *rest = body.split(":")
    form = FORMS.get(letter)
    if form is None or len(rest) < 2:  # noqa: PLR2004 -- the name and the copy
        raise InputError(f"It is of a kind {clipped(letter)!r}, and the kinds are {', '.join(FORMS)}.")
    name, fields, copy = rest[0], rest[1:-1], rest[-1]
    if not re.fullmatch(r"[0-9]{1,4}", copy):
        raise InputError(f"Its copy is {clipped(copy)!r}, and not a number up to {MOST_COPIES}.")
    try:
        target = form.target(_decoded_name(name), fields)
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(str(part) for part in first["loc"])
        raise InputError(f"It describes no target: {where}: {first['msg']}.") from error
    _require_printable(target)
    return PrintedTarget(_shipped(target), int(copy))


def text_number(text: str, numbers: int) -> int:
    """Return a number below `numbers` that depends on the whole text."""
    return zlib.crc32(text.encode("ascii", "replace")) % numbers


def _shipped(target: AnyTarget) -> AnyTarget:
    """Return the shipped target of that name where it is printed alike: it has words for people, too."""
    if target.name not in target_names():
        return target
    shipped = load_target(target.name)
    return shipped if code_text(shipped) == code_text(target) else target


def _require_printable(target: AnyTarget) -> None:
    """Raise where no printer makes such a sheet."""
    x_min, y_min, x_max, y_max = target.extent_mm
    across, up = x_max - x_min, y_max - y_min
    if target.count > MOST_DOTS:
        raise InputError(f"It claims {target.count} dots, and a print with a code has at most {MOST_DOTS}.")
    if not max(across, up) <= MOST_SHEET_MM:
        raise InputError(
            f"It claims to be {across:.6g} mm x {up:.6g} mm large, and a print with a code is at most "
            f"{MOST_SHEET_MM:.6g} mm long."
        )
    if not across * up >= target.count * LEAST_PITCH_MM**2:
        raise InputError(
            f"It claims {target.count} dots on {across:.3g} mm x {up:.3g} mm, finer than a printer's "
            f"{LEAST_PITCH_MM:g} mm."
        )


def _encoded_name(name: str) -> str:
    """Return a name in capital letters; those that are capital ones have a mark before them."""
    return "".join(f"{_CAPITAL}{letter}" if letter.isupper() else letter.upper() for letter in name)


def _decoded_name(code: str) -> str:
    """Return the name that is encoded."""
    name = re.sub(r"(\$?)([A-Z])", lambda found: found[2] if found[1] else found[2].lower(), code)
    if not is_name(name):
        raise InputError(f"Its name is {clipped(name)!r}, and a name has letters, digits and hyphens.")
    return name


def _checksum(text: str) -> str:
    """Return a text's CRC-32 to base 36."""
    number, letters = zlib.crc32(text.encode("ascii", "replace")), ""
    for _ in range(_CHECKSUM_LETTERS):
        number, digit = divmod(number, len(_DIGITS))
        letters = _DIGITS[digit] + letters
    return letters
