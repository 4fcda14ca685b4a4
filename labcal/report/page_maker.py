"""The words and the origin of a page, common to the builders of pages."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.provenance import Provenance


@dataclass(frozen=True)
class PageMaker:
    """Words and origin of a page.

    Attributes
    ----------
    provenance : Provenance
    phrase : callable
        What turns a message of the library into the reader's words.
    """

    provenance: Provenance
    phrase: Callable[[str], str]

    def notes(self, messages: Sequence[str]) -> list[Part]:
        """Return warnings as notes, each in a box of its own."""
        return [Prose((_sentence(self.phrase(message)),), Tone.NOTE) for message in messages]


def _sentence(text: str) -> str:
    """Return a message with a capital letter and a full stop."""
    return f"{text[:1].upper()}{text[1:]}{'' if text.endswith(('.', '?')) else '.'}"
