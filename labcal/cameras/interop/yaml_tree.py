"""YAML of other systems: mappings, lists and scalars only, and OpenCV's matrices; numbers stay texts."""

import re
from collections.abc import Hashable
from pathlib import Path
from typing import Any

import yaml

from labcal.cameras.interop.opencv_base64 import marked
from labcal.errors import InputError
from labcal.run.yaml_reading import PlainLoader, yaml_content

_TEXT = "tag:yaml.org,2002:str"
_GLUED = re.compile(r"([A-Za-z_][A-Za-z0-9_.-]*):(\S.*)", re.DOTALL)
"""Key and value without a blank between them."""
_MATRIX_TAGS = ("tag:yaml.org,2002:opencv-matrix", "tag:yaml.org,2002:opencv-nd-matrix")


class _Loader(PlainLoader):
    """A plain loader that knows OpenCV's tags, and its maps in one line, ``{ width:1280, height:720 }``."""

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:  # noqa: FBT001, FBT002 -- PyYAML's own signature
        """Return a mapping; without a blank behind its colon a key is parted from its value here."""
        if isinstance(node, yaml.MappingNode) and node.flow_style:  # a damaged matrix may be a scalar
            node.value = [self._parted(key, value) for key, value in node.value]
        return super().construct_mapping(node, deep=deep)

    def _parted(self, key: yaml.Node, value: yaml.Node) -> tuple[yaml.Node, yaml.Node]:
        """Return key and value of ``width:1280``, which YAML takes for a key without a value."""
        glued = (
            _GLUED.fullmatch(key.value) if _is_plain(key) and _is_plain(value) and not value.value else None
        )
        if glued is None:
            return key, value
        word, text = glued[1], glued[2]
        quoted = text[0] == text[-1] == '"' and len(text) > 1
        parts = (word, text[1:-1] if quoted else text)
        word_node, text_node = (yaml.ScalarNode(_TEXT, one, key.start_mark, key.end_mark) for one in parts)
        return word_node, text_node


def _is_plain(node: yaml.Node) -> bool:
    """Tell whether a node is a scalar without quotes."""
    return isinstance(node, yaml.ScalarNode) and node.style is None


def _base64(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> str:
    return marked(str(loader.construct_scalar(node)))


def _plain_mapping(loader: yaml.SafeLoader, node: yaml.MappingNode) -> dict[Any, Any]:
    return loader.construct_mapping(node, deep=True)


def _number_as_text(loader: yaml.SafeLoader, node: yaml.ScalarNode) -> object:
    return loader.construct_scalar(node)


# YAML 1.1 takes 0700 for 448, 1:30 for 90 and 1_0 for 10, which nobody means who writes a matrix.
for _tag in ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float"):
    _Loader.add_constructor(_tag, _number_as_text)
_Loader.add_constructor("tag:yaml.org,2002:binary", _base64)
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
