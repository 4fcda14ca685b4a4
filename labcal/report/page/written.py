"""Parts of pages with templates of their own."""

from collections.abc import Mapping
from dataclasses import dataclass

from markupsafe import Markup

from labcal.report.page.part import Part
from labcal.report.page.templates import rendered


@dataclass(frozen=True)
class Written(Part):
    """A part of a single page, which has a template of its own.

    Attributes
    ----------
    template : str
        The name of its file.
    values : mapping of str to object
        By the names that the template knows them by.
    """

    template: str
    values: Mapping[str, object]

    def html(self) -> Markup:
        """Return what the template makes."""
        return rendered(self.template, self.values)
