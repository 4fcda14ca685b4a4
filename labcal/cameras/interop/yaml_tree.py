"""YAML of other systems: mappings, lists and scalars only, and OpenCV's matrices."""

from pathlib import Path
from typing import Any

import yaml

from labcal.errors import InputError

_MATRIX_TAGS = ("tag:yaml.org,2002:opencv-matrix", "tag:yaml.org,2002:opencv-nd-matrix")


class _Loader(yaml.SafeLoader):
    """A safe loader that refuses aliases: a thousand letters of them can stand for gigabytes."""

    def compose_node(self, parent: Any, index: Any) -> Any:  # noqa: ANN401 -- PyYAML's own signature
        """Return the next node."""
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("aliases are not read")
        return super().compose_node(parent, index)


def _plain_mapping(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


for _tag in _MATRIX_TAGS:
    _Loader.add_constructor(_tag, _plain_mapping)


def read_yaml_tree(text: str, source: Path) -> dict[str, Any]:
    """Return the mapping in a YAML text; a matrix of OpenCV is the mapping of its keys.

    Raises
    ------
    InputError
        The text is no YAML, uses aliases or other tags, or holds no mapping.
    """
    # OpenCV's first line, "%YAML:1.0", is no directive that YAML knows.
    lines = text.split("\n", 1)
    body = lines[1] if lines[0].startswith("%YAML:") and len(lines) > 1 else text
    try:
        content = yaml.load(body, _Loader)  # noqa: S506 -- a SafeLoader
    except (yaml.YAMLError, ValueError, RecursionError, OverflowError) as error:
        told = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{source} is not YAML that is read here: {told:.200}.") from error
    if not isinstance(content, dict):
        raise InputError(f"{source} should hold keys with values, but holds something else.")
    return content
