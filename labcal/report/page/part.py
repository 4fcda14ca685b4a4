"""A part of a page."""

from abc import ABC, abstractmethod

from markupsafe import Markup

from labcal.report.page.asset import Asset


class Part(ABC):
    """A table, a figure, a few sentences: what a section of a page is made of."""

    @abstractmethod
    def html(self) -> Markup:
        """Return the part as HTML; texts that it holds are escaped."""

    @property
    def assets(self) -> tuple[Asset, ...]:
        """Data of the part that stand at the end of the page, so that nobody waits for them."""
        return ()
