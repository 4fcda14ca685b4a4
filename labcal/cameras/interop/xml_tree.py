"""XML of other systems as a tree; nothing that a document type declares is believed or fetched."""

from pathlib import Path
from typing import NoReturn
from xml.etree import ElementTree as ET
from xml.parsers import expat

from labcal.errors import InputError

_MOST_DEEP = 100
Attributes = dict[str, str]


class _RefusedError(ValueError):
    """Legal XML that is not read."""


class _Builder:
    """Builds a tree that is not too deep."""

    def __init__(self) -> None:
        self._tree = ET.TreeBuilder()
        self._depth = 0

    def start(self, tag: str, attributes: Attributes) -> None:
        self._depth += 1
        if self._depth > _MOST_DEEP:
            raise _RefusedError(f"elements lie in each other more than {_MOST_DEEP} deep")
        self._tree.start(tag, attributes)

    def end(self, tag: str) -> None:
        self._depth -= 1
        self._tree.end(tag)

    def data(self, text: str) -> None:
        self._tree.data(text)

    def close(self) -> ET.Element:
        return self._tree.close()


def _refuse_entity(*_: object) -> NoReturn:
    raise _RefusedError("it declares entities, which are not resolved")


def read_xml_tree(text: str, source: Path) -> ET.Element:
    """Return the outermost element.

    Raises
    ------
    InputError
        The text is no XML, declares entities, or is nested beyond reason.
    """
    builder = _Builder()
    parser = expat.ParserCreate("utf-8")
    parser.StartElementHandler = builder.start
    parser.EndElementHandler = builder.end
    parser.CharacterDataHandler = builder.data
    parser.EntityDeclHandler = _refuse_entity
    parser.UnparsedEntityDeclHandler = _refuse_entity
    parser.ExternalEntityRefHandler = _refuse_entity
    try:
        parser.Parse(text.encode(), True)
        return builder.close()
    except (expat.ExpatError, _RefusedError, AssertionError) as error:
        raise InputError(f"{source} is not XML that is read here: {error}.") from error
