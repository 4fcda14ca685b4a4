"""Reading of YAML: mappings, lists and scalars, each key once, without aliases."""

import re
from collections.abc import Hashable
from typing import Any

import yaml

from labcal.errors import InputError
from labcal.wording import clipped, shown

_MOST_DEEP = 50
_DECIMAL = re.compile(
    r"[-+]?(?:0|[1-9][0-9]*|[0-9]*\.[0-9]*(?:[eE][-+]?[0-9]+)?|\.(?:inf|nan))", re.IGNORECASE
)
_MERGE = "tag:yaml.org,2002:merge"


class PlainLoader(yaml.SafeLoader):
    """A safe loader without aliases, merge keys and keys that come twice.

    A thousand characters of aliases can expand to gigabytes.
    """

    def __init__(self, stream: Any) -> None:  # noqa: ANN401 -- PyYAML's own signature
        super().__init__(stream)
        self._depth = 0

    def compose_node(self, parent: Any, index: Any) -> Any:  # noqa: ANN401 -- PyYAML's own signature
        """Return the next node."""
        if self.check_event(yaml.AliasEvent):
            raise yaml.YAMLError("aliases (*name) are not read; write the value out")
        self._depth += 1
        if self._depth > _MOST_DEEP:
            raise yaml.YAMLError(f"it is nested more than {_MOST_DEEP} deep")
        node = super().compose_node(parent, index)
        self._depth -= 1
        return node

    def construct_scalar(self, node: yaml.ScalarNode | yaml.MappingNode) -> Any:  # noqa: ANN401 -- PyYAML's own signature
        """Return the text of a scalar, which must be one that can be written."""
        value = super().construct_scalar(node)
        if isinstance(value, str) and not value.isascii() and any("\ud800" <= c <= "\udfff" for c in value):
            raise yaml.YAMLError("halves of characters (surrogates) are not read; write the character out")
        return value

    def construct_number(self, node: yaml.ScalarNode) -> object:
        """Return a number, which must be decimal: YAML 1.1 takes 010 for 8, 1:30 for 90, and 1_0 for 10."""
        text = str(self.construct_scalar(node))
        if not _DECIMAL.fullmatch(text):
            raise yaml.YAMLError(f"the number {shown(text)} is not decimal; write it as 90 or 0.5, say")
        whole = node.tag == "tag:yaml.org,2002:int"
        return self.construct_yaml_int(node) if whole else self.construct_yaml_float(node)

    def construct_mapping(self, node: yaml.MappingNode, deep: bool = False) -> dict[Hashable, Any]:  # noqa: FBT001, FBT002 -- PyYAML's own signature
        """Return a mapping whose keys are all different."""
        seen: set[object] = set()
        for key_node, _ in node.value:
            if key_node.tag == _MERGE:
                raise yaml.YAMLError("merge keys (<<) are not read; write the keys out")
            key = self.construct_object(key_node, deep=True)
            if isinstance(key, Hashable):
                if key in seen:
                    raise yaml.YAMLError(f"the key {shown(key)} occurs twice in one mapping")
                seen.add(key)
        return super().construct_mapping(node, deep=deep)


for _tag in ("tag:yaml.org,2002:int", "tag:yaml.org,2002:float"):
    PlainLoader.add_constructor(_tag, PlainLoader.construct_number)


def yaml_content(text: str, source: str, loader: type[PlainLoader] = PlainLoader) -> object:
    """Return the content of a YAML text.

    Parameters
    ----------
    text : str
    source : str
        Where it comes from, for messages.
    loader : type
        A :class:`PlainLoader` that knows further tags.

    Raises
    ------
    InputError
        The text is no YAML, or has what is not read.
    """
    try:
        return yaml.load(text, loader)  # noqa: S506 -- a SafeLoader
    # PyYAML meets some damaged texts with errors of its own making.
    except (yaml.YAMLError, ValueError, ArithmeticError, RecursionError, LookupError, TypeError) as error:
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(f"{source} is not valid YAML: {clipped(reason, 300)}.") from error
