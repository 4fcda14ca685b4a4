"""A page: a title, sections, and what it was made by."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import StrEnum

from labcal.report.page.asset import Asset
from labcal.report.page.part import Part
from labcal.report.page.provenance import Provenance
from labcal.report.page.templates import rendered
from labcal.run.file_kinds import FileKind, recognised_by
from labcal.run.file_marks import HTML_COMMENT

_HEAD_BYTES = 1024
_MADE_BY = b'<meta name="generator" content="labcal">'
PAGE_KIND = FileKind("a page of labcal", lambda content: _MADE_BY in content[:_HEAD_BYTES], HTML_COMMENT)
"""A page that is an output by itself."""
INNER_PAGE_KIND = recognised_by(PAGE_KIND.name, PAGE_KIND.recognises)
"""A page in a folder of results, whose mark tells whether somebody has edited the page."""


class Paper(StrEnum):
    """The way a page lies on paper when it is printed, which is also its name in the style."""

    LANDSCAPE = "landscape"
    PORTRAIT = "portrait"


@dataclass(frozen=True)
class Section:
    """A heading and what stands below it."""

    heading: str
    parts: Sequence[Part]

    @property
    def name(self) -> str:
        """Its id in the page."""
        return "-".join(re.findall(r"[a-z0-9]+", self.heading.lower()))


@dataclass(frozen=True)
class Page:
    """A page that needs nothing beside it: styles, figures, pictures, data and scripts are in it.

    It fetches nothing: its own policy forbids the browser to. The same page gives the same text.

    Attributes
    ----------
    title : str
        Of the window.
    heading : str
    lead : str
        What the page is about, in a sentence or two.
    sections : sequence of Section
        The first one says the outcome in words.
    provenance : Provenance
    """

    title: str
    heading: str
    lead: str
    sections: Sequence[Section]
    provenance: Provenance
    opening: Sequence[Part] = field(default=())
    """Above the first heading: the outcome."""
    paper: Paper = Paper.LANDSCAPE

    def text(self) -> str:
        """Return the page as HTML."""
        values = {"page": self, "assets": self._assets()}
        return str(rendered("page.html.jinja", values))

    def _assets(self) -> list[Asset]:
        """Return the data of all parts, each once."""
        return list({asset.name: asset for part in self._parts() for asset in part.assets}.values())

    def _parts(self) -> Iterator[Part]:
        yield from self.opening
        for section in self.sections:
            yield from section.parts
