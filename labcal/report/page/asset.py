"""Data that a page carries unread until somebody asks for it: compressed, and inert."""

import gzip
from base64 import b64encode
from dataclasses import dataclass
from functools import cached_property

from markupsafe import Markup

_LEVEL = 6
"""Higher ones take three times as long for a fiftieth less."""


@dataclass(frozen=True)
class Asset:
    """Bytes in a page, such as the table behind a figure or the script of the 3-D view.

    Attributes
    ----------
    name : str
        Its id in the page.
    data : bytes
        As they are when somebody asks for them.
    """

    name: str
    data: bytes

    @cached_property
    def packed(self) -> str:
        """The bytes, compressed, in base64."""
        return b64encode(gzip.compress(self.data, _LEVEL, mtime=0)).decode()

    def html(self) -> Markup:
        """Return the element that holds them: a script of a type that no browser runs or reads."""
        return Markup('<script type="application/gzip" id="{}">{}</script>').format(self.name, self.packed)
