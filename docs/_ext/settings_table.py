"""``{settings} module:Class``: every field of a settings object, from the code.

The description of a field is its pydantic one, or else the docstring below it; a field of a dataclass has the
latter only. A field without a description is an error, as in every reference.
"""

import dataclasses
import inspect
import types
from collections.abc import Iterator
from enum import Enum
from typing import Annotated, Any, ClassVar, Literal, NamedTuple, Union, get_args, get_origin

from annotated_types import Ge, Gt, Interval, Le, Lt
from attribute_docs import attribute_docs
from docutils import nodes
from docutils.parsers.rst import directives
from public_object import public_object
from pydantic import BaseModel
from pydantic_core import PydanticUndefined
from sphinx.application import Sphinx
from sphinx.util.docutils import SphinxDirective
from tables import code, table


class Field(NamedTuple):
    """A field of a settings object as the table shows it."""

    name: str
    kind: str
    default: str
    meaning: str


def fields_of(settings: type) -> Iterator[Field]:
    """Return the fields of a pydantic model or a dataclass."""
    docs = attribute_docs(settings)
    if issubclass(settings, BaseModel):
        for name, info in settings.model_fields.items():
            default: object = info.default
            if info.default_factory is not None:
                default = info.default_factory()
            limits = _limits(info.metadata)
            kind = " ".join(part for part in (_kind(info.annotation), limits) if part)
            yield Field(name, kind, _default(default), info.description or docs.get(name, ""))
        return
    if not dataclasses.is_dataclass(settings):
        raise TypeError(f"{settings.__name__} is neither a pydantic model nor a dataclass.")
    for field in dataclasses.fields(settings):
        default = field.default
        if field.default_factory is not dataclasses.MISSING:
            default = field.default_factory()
        yield Field(field.name, _kind(field.type), _default(default), docs.get(field.name, ""))


def _default(value: object) -> str:
    """Return a default as a person writes it; nothing where a value must be given."""
    if value is PydanticUndefined or value is dataclasses.MISSING:
        return "required"
    if isinstance(value, BaseModel):
        return "its own defaults"
    return code(value.value if isinstance(value, Enum) else repr(value))


def _kind(annotation: Any) -> str:  # noqa: ANN401 - annotations have no common type
    """Return the type of a field in words."""
    origin, parts = get_origin(annotation), get_args(annotation)
    if isinstance(annotation, str):
        words = annotation
    elif annotation is None or annotation is type(None):
        words = "none"
    elif origin is Annotated:
        words = " ".join(part for part in (_kind(parts[0]), _limits(parts[1:])) if part)
    elif origin in {Union, types.UnionType}:
        words = " or ".join(_kind(part) for part in parts)
    elif origin is Literal:
        words = "one of " + ", ".join(code(part) for part in parts) if len(parts) > 1 else code(parts[0])
    elif origin is not None:
        inside = ", ".join(_kind(part) for part in parts if part is not Ellipsis)
        words = f"{getattr(origin, '__name__', str(origin))} of {inside}"
    elif inspect.isclass(annotation) and issubclass(annotation, Enum):
        words = "one of " + ", ".join(code(member.value) for member in annotation)
    else:
        words = getattr(annotation, "__name__", str(annotation))
    return words


def _limits(metadata: Any) -> str:  # noqa: ANN401 - as pydantic has them
    """Return the bounds of a number in words."""
    said = []
    for one in metadata:
        match one:
            case Interval():
                said += [_limits([part]) for part in one]
            case Gt(gt=bound):
                said.append(f"> {bound}")
            case Ge(ge=bound):
                said.append(f"≥ {bound}")
            case Lt(lt=bound):
                said.append(f"< {bound}")
            case Le(le=bound):
                said.append(f"≤ {bound}")
            case _ if hasattr(one, "metadata"):  # Field(...) within Annotated
                said.append(_limits(one.metadata))
    return ", ".join(part for part in said if part)


class SettingsTable(SphinxDirective):
    """The fields of a settings object as a table; with ``:prefix:`` the names as ``--set`` takes them."""

    required_arguments = 1
    option_spec: ClassVar = {"prefix": directives.unchanged}

    def run(self) -> list[nodes.Node]:
        """Return the table."""
        settings = public_object(self.arguments[0])
        if not isinstance(settings, type):
            raise self.error(f"{self.arguments[0]} is no class.")
        fields = list(fields_of(settings))
        silent = [field.name for field in fields if not field.meaning]
        if silent:
            raise self.error(f"{self.arguments[0]} says nothing of {', '.join(silent)}.")
        prefix = self.options.get("prefix", "")
        rows = [[code(prefix + name), kind, default, meaning] for name, kind, default, meaning in fields]
        return self.parse_text_to_nodes(table(["name", "type", "default", "meaning"], rows))


def setup(app: Sphinx) -> dict[str, bool]:
    """Add the directive."""
    app.add_directive("settings", SettingsTable)
    return {"parallel_read_safe": True}
