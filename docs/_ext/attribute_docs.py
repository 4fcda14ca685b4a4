"""Docstrings of attributes: the string that stands below a field or a member of an enumeration."""

import ast
import inspect
import textwrap


def attribute_docs(of: type) -> dict[str, str]:
    """Return the docstring of each attribute of a class, those of its bases included."""
    found: dict[str, str] = {}
    for one in reversed(of.__mro__):
        if one.__module__.partition(".")[0] == "labcal":
            found |= _own_docs(one)
    return found


def _own_docs(of: type) -> dict[str, str]:
    """Return the docstrings of the attributes that stand in the body of the class itself."""
    try:
        (body,) = ast.parse(textwrap.dedent(inspect.getsource(of))).body
    except (OSError, TypeError):  # made by a call, without a source
        return {}
    if not isinstance(body, ast.ClassDef):
        return {}
    docs = {}
    for before, after in zip(body.body, body.body[1:], strict=False):
        match before, after:
            case (
                ast.AnnAssign(target=ast.Name(id=name)) | ast.Assign(targets=[ast.Name(id=name)]),
                ast.Expr(value=ast.Constant(value=str(text))),
            ):
                docs[name] = " ".join(text.split())
    return docs
