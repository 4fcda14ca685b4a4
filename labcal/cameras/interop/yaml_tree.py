"""YAML of other systems: mappings, lists and scalars only, and OpenCV's matrices; numbers stay texts."""

from pathlib import Path
from typing import Any

import yaml

from labcal.errors import InputError
from labcal.run.yaml_reading import PlainLoader, yaml_content

_MATRIX_TAGS = ("tag:yaml.org,2002:opencv-matrix", "tag:yaml.org,2002:opencv-nd-matrix")


class _Loader(PlainLoader):
    """A plain loader that knows OpenCV's tag."""


def _plain_mapping(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


def _number_as_text(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> object:
    return loader.construct_scalar(node)


# YAML 1.1 takes 0700 for 448, 1:30 for 90 and 1_0 for 10, which nobody means who writes a matrix.
for _tag in ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float"):
    _Loader.add_constructor(_tag, _number_as_text)
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
    content = yaml_content(body, str(source), _Loader)
    if not isinstance(content, dict):
        raise InputError(f"{source} should hold keys with values, but holds something else.")
    return content
