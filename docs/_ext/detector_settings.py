"""``{detector-settings} STAGE``: every setting of one stage of detection, from the code."""

from docutils import nodes
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import code, table

from labcal.detect.settings import describe_settings
from labcal.detect.stage_settings.setting import SettingValue


class DetectorSettings(SphinxDirective):
    """The settings of a stage as a table, under the names that ``--set`` takes."""

    required_arguments = 1

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        stage = f"detect.{self.arguments[0]}."
        found = [setting for setting in describe_settings() if setting.name.startswith(stage)]
        if not found:
            raise self.error(f"{self.arguments[0]} is no stage of detection.")
        rows = [
            [code(one.name), f"{_text(one.default)} {one.unit}", one.bounds, one.description] for one in found
        ]
        made = self.parse_text_to_nodes(table(["name", "default", "bounds", "meaning"], rows))
        for node in made:
            if isinstance(node, nodes.table):
                node["classes"].append("long-names")
        return made


def _text(value: SettingValue) -> str:
    """Return a default as ``--set`` takes it."""
    return ",".join(map(str, value)) if isinstance(value, tuple) else str(value)


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("detector-settings", DetectorSettings)
    return {"parallel_read_safe": True}
