"""Committed result files: the base of the directives that show a part of one.

The argument is the file, relative to the page. Its hash stands below each part, so that a table cannot be
told from its file.
"""

import hashlib
from abc import abstractmethod
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import ClassVar, Generic, TypeVar

from docutils import nodes
from pydantic import BaseModel
from sphinx.util.docutils import SphinxDirective

from labcal.run.documents import read_document

Result = TypeVar("Result", bound=BaseModel)

_ABSENT = """:::{{note}}
The results of a full run of `{command}` are not committed yet; the command computes them.
:::
"""


class CommittedResults(SphinxDirective, Generic[Result]):
    """A part of a result file."""

    required_arguments = 1
    model: ClassVar[type[BaseModel]]
    command: ClassVar[str]
    note: ClassVar[str] = ""

    def run(self) -> list[nodes.Node]:
        """Return what the result file says, and its hash."""
        path = (Path(self.env.doc2path(self.env.docname)).parent / self.arguments[0]).resolve()
        self.env.note_dependency(str(path))
        if not path.is_file():
            return self.parse_text_to_nodes(_ABSENT.format(command=self.command))
        result = read_document(self.model, "result file", path)
        digest = hashlib.sha256(path.read_bytes()).hexdigest()
        name = path.relative_to(Path(self.env.srcdir).resolve()).as_posix()
        return [
            *self.content_of(result),
            *self.parse_text_to_nodes(f"{self.note}From `docs/{name}`, SHA-256 `{digest}`.\n"),
        ]

    @abstractmethod
    def content_of(self, result: Result) -> Iterator[nodes.Node]:
        """Yield what is shown."""


def listed(sentences: Iterable[str]) -> str:
    """Return sentences as a list in Markdown."""
    return "".join(f"- {sentence}\n" for sentence in sentences)
