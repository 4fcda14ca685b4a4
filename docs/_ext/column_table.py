"""``{columns} module:HEADER``: the columns of a table, in their order in the file, with what each holds.

Each line of the directive is ``names: meaning``; columns of one meaning stand together. Names that are not
those of the code, or not in its order, are an error.
"""

from docutils import nodes
from public_object import public_object
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import code, table


class ColumnTable(SphinxDirective):
    """The columns of a CSV file as a table."""

    required_arguments = 1
    has_content = True

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        header = public_object(self.arguments[0])
        lines = [line.partition(": ") for line in self.content if line.strip()]
        groups = [([name.strip() for name in names.split(",")], meaning) for names, _, meaning in lines]
        named = [name for names, _ in groups for name in names]
        if named != list(header):
            raise self.error(f"{self.arguments[0]} is {header}, and not {named}.")
        rows = [[", ".join(map(code, names)), meaning] for names, meaning in groups]
        return self.parse_text_to_nodes(table(["column", "meaning"], rows))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("columns", ColumnTable)
    return {"parallel_read_safe": True}
