"""How a page speaks to its reader, and what it was made by: what the builders of pages share."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.provenance import Provenance


@dataclass(frozen=True)
class PageMaker:
    """What is the same for every page.

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
        return [Prose((_capital(self.phrase(message)),), Tone.NOTE) for message in messages]


def _capital(text: str) -> str:
    return text[:1].upper() + text[1:]
