"""The origin of a page: command, versions and files."""

import hashlib
import sys
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path

from markupsafe import Markup

from labcal.paths import AnyPath, as_path
from labcal.report.page.part import Part
from labcal.report.page.templates import rendered
from labcal.run.machine import package_version
from labcal.shoot.dataset import MANIFEST

_PACKAGES = ("labcal", "numpy", "scipy", "opencv-contrib-python-headless")


@dataclass(frozen=True)
class Provenance(Part):
    """The command that makes a page again, the versions that it ran with, and the files that it read.

    No time and no name of a machine is in it, so that the same command on the same files gives the same page.

    Attributes
    ----------
    command : str
        As it is typed, or the function that was called.
    versions : mapping of str to str
        By package.
    inputs : mapping of str to str
        SHA-256 by the path as it was given.
    """

    command: str
    versions: Mapping[str, str]
    inputs: Mapping[str, str]

    @classmethod
    def of(cls, command: str, inputs: Iterable[AnyPath | None], home: AnyPath = ".") -> "Provenance":
        """Return the provenance of a page that is made now.

        Parameters
        ----------
        command : str
        inputs : iterable of path or None
            Files that were read; of a folder of a shoot, its manifest. Names that are no paths are left out.
        home : path
            The folder that they are relative to.
        """
        versions = {"Python": ".".join(map(str, sys.version_info[:3]))}
        versions |= {name: found for name in _PACKAGES if (found := package_version(name)) is not None}
        digests = {}
        for given in (as_path(one) for one in inputs if one is not None):
            at = as_path(home) / given
            file = MANIFEST if (at / MANIFEST).is_file() else ""
            if (at / file).is_file():
                digests[str(given / file)] = _digest(at / file)
        return cls(command, versions, digests)

    def html(self) -> Markup:
        """Return it as a list."""
        return rendered("provenance.html.jinja", {"provenance": self})


def _digest(file: Path) -> str:
    """Return the SHA-256 of a file."""
    with file.open("rb") as opened:
        return hashlib.file_digest(opened, "sha256").hexdigest()
