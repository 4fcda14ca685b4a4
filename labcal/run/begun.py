"""The mark of an unfinished folder: the command that makes it, and the code that began it."""

from contextlib import suppress
from pathlib import Path

from pydantic import BaseModel, ConfigDict, ValidationError

from labcal.run.code_version import CodeVersion, code_version

COMMAND = ".labcal-command"
"""Name of the mark."""


class Begun(BaseModel):
    """The content of the mark."""

    model_config = ConfigDict(frozen=True, extra="forbid")

    command: str
    """Everything that determines the content of the folder, as text."""
    version: str | None = None
    """Version of labcal that began it; null in the mark of a version that did not note it."""
    code_sha256: str | None = None
    """Digest of its sources; null likewise."""

    @classmethod
    def now(cls, command: str) -> "Begun":
        """Return the mark of a folder that this code begins."""
        code = code_version()
        return cls(command=command, version=code.version, code_sha256=code.sha256)

    @property
    def code(self) -> str:
        """The code that began it, for people."""
        if self.version is None or self.code_sha256 is None:
            return "an earlier version of labcal"
        return str(CodeVersion(self.version, self.code_sha256))

    def text(self) -> str:
        """Return the text of the mark."""
        return self.model_dump_json() + "\n"


def begun_in(folder: Path) -> Begun | None:
    """Return the mark of an unfinished folder; None if there is none.

    Earlier versions wrote the command alone.
    """
    mark = folder / COMMAND
    if not mark.is_file() or mark.is_symlink():
        return None
    text = mark.read_text(encoding="utf-8", errors="replace")
    with suppress(ValidationError):
        return Begun.model_validate_json(text)
    return Begun(command=text)
