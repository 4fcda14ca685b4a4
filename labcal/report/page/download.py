"""A file that a page holds and hands out."""

from dataclasses import dataclass

from labcal.report.page.asset import Asset


@dataclass(frozen=True)
class Download:
    """A file inside the page.

    Attributes
    ----------
    file : str
        The name that it gets when it is saved: ``residuals.csv``.
    text : str
        Its content.
    """

    file: str
    text: str

    @property
    def asset(self) -> Asset:
        """The content in the page."""
        return Asset(f"file-{self.file.replace('.', '-')}", self.text.encode())

    @property
    def label(self) -> str:
        """The text of its button: the kind of the file."""
        return self.file.rpartition(".")[2].upper()
