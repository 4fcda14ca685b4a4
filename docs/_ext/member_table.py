"""``{members} module:Enumeration``: its values with what each says, from the code.

With ``:advice:`` a function of the same module adds the advice that people get for a value.
"""

from enum import Enum
from typing import ClassVar

from attribute_docs import attribute_docs
from docutils import nodes
from docutils.parsers.rst import directives
from public_object import public_object
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import code, table


class MemberTable(SphinxDirective):
    """The members of an enumeration as a table."""

    required_arguments = 1
    option_spec: ClassVar = {"advice": directives.unchanged}

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        kind = public_object(self.arguments[0])
        if not (isinstance(kind, type) and issubclass(kind, Enum)):
            raise self.error(f"{self.arguments[0]} is no enumeration.")
        docs = attribute_docs(kind)
        missing = [member.name for member in kind if not docs.get(member.name)]
        if missing:
            raise self.error(f"{self.arguments[0]} says nothing of {', '.join(missing)}.")
        head = ["value", "meaning"]
        rows = [[code(member.value), docs[member.name]] for member in kind]
        if "advice" in self.options:
            advice = public_object(self.options["advice"])
            head.append("advice")
            rows = [[*row, advice(member)] for row, member in zip(rows, kind, strict=True)]
        return self.parse_text_to_nodes(table(head, rows))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("members", MemberTable)
    return {"parallel_read_safe": True}
