"""``{decisions}``: every decision with its date and status, the newest first."""

import re
from pathlib import Path

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import table

FORM = re.compile(r"# (?P<title>.+)\n\nStatus: (?P<status>.+)\n\n")
DATED = re.compile(r"(?P<date>\d{4}-\d{2}-\d{2})-.+")


class DecisionTable(SphinxDirective):
    """The decisions in the folder of the page as a table."""

    def run(self) -> list[nodes.Node]:
        """Return the table; a file of another form is an error."""
        rows = []
        for path in sorted(Path(self.env.doc2path(self.env.docname)).parent.glob("2*.md"), reverse=True):
            self.env.note_dependency(str(path))
            name, head = DATED.fullmatch(path.stem), FORM.match(path.read_text(encoding="utf-8"))
            if name is None or head is None:
                raise self.error(f"{path.name}: a decision begins '# Title', '', 'Status: ...', ''.")
            rows.append([name["date"], f"[{head['title']}]({path.name})", head["status"]])
        found = self.parse_text_to_nodes(table(["date", "decision", "status"], rows))
        for node in found:
            node["classes"].append("dated")
        return found


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("decisions", DecisionTable)
    return {"parallel_read_safe": True}
