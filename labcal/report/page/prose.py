"""Sentences in a page."""

from dataclasses import dataclass
from enum import StrEnum

from markupsafe import Markup

from labcal.report.page.part import Part
from labcal.report.page.templates import rendered


class Tone(StrEnum):
    """The look of sentences, which is also the name of its style."""

    PLAIN = "plain"
    QUIET = "quiet"
    NOTE = "note"
    """In a box: nobody should miss it."""


@dataclass(frozen=True)
class Prose(Part):
    """Paragraphs, or the items of a list in a box.

    Attributes
    ----------
    paragraphs : tuple of str
    tone : Tone
    """

    paragraphs: tuple[str, ...]
    tone: Tone = Tone.PLAIN

    def html(self) -> Markup:
        """Return the paragraphs."""
        return rendered("prose.html.jinja", {"prose": self})


@dataclass(frozen=True)
class Terms(Part):
    """Words of the page, each with what it means."""

    entries: tuple[tuple[str, str], ...]

    def html(self) -> Markup:
        """Return the list of definitions."""
        return rendered("terms.html.jinja", {"entries": self.entries})
