"""Files that a page hands out, beside each other."""

from dataclasses import dataclass

from markupsafe import Markup

from labcal.report.page.asset import Asset
from labcal.report.page.download import Download
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered


@dataclass(frozen=True)
class Files(Part):
    """Buttons that save files of the page, with their names."""

    files: tuple[Download, ...]

    def html(self) -> Markup:
        """Return the buttons."""
        return rendered("files.html.jinja", {"files": self.files})

    @property
    def assets(self) -> tuple[Asset, ...]:
        """The files."""
        return tuple(file.asset for file in self.files)
