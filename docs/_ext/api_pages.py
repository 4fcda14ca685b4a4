"""One page for each public name, written before the site is read.

Public names are those of :mod:`labcal` (its stub lists them) and :data:`labcal.pipeline.__all__`: there is no
list of them here.
"""

import inspect
from pathlib import Path
from types import ModuleType

from sphinx.application import Sphinx

import labcal
from labcal import pipeline

FOLDER = Path("reference", "api")


def public_names() -> dict[str, object]:
    """Return the public objects by their full names: what is called or made, and no module."""
    found = {f"labcal.{name}": getattr(labcal, name) for name in labcal.__all__}
    found |= {f"labcal.pipeline.{name}": getattr(pipeline, name) for name in pipeline.__all__}
    return {name: one for name, one in found.items() if callable(one) and not isinstance(one, ModuleType)}


def write_pages(app: Sphinx) -> None:
    """Write the pages; one whose name is gone is removed, one that has not changed is left."""
    folder = app.srcdir / FOLDER
    folder.mkdir(parents=True, exist_ok=True)
    names = public_names()
    pages = {folder / f"{name}.rst": _page(name, one) for name, one in names.items()}
    pages[folder / "index.rst"] = _index(names)
    for stale in set(folder.glob("*.rst")) - set(pages):
        stale.unlink()
    for path, text in pages.items():
        if not path.exists() or path.read_text(encoding="utf-8") != text:
            path.write_text(text, encoding="utf-8")


def _page(name: str, one: object) -> str:
    """Return the page of one public name in reStructuredText."""
    title = name.rpartition(".")[2]
    module, _, plain = name.rpartition(".")
    kind = "class" if inspect.isclass(one) else "function"
    # Where it is defined is an address that may change; the public name is the one to import.
    lines = [title, "=" * len(title), "", f".. currentmodule:: {module}", "", f".. auto{kind}:: {plain}"]
    if kind == "class":
        lines += ["   :members:"]
        if issubclass(one, BaseException):
            lines += ["   :show-inheritance:"]
    return "\n".join([*lines, ""])


def _index(names: dict[str, object]) -> str:
    """Return the page that lists all public names by module, each with the first line of its docstring."""
    title = "Python interface"
    lines = [title, "=" * len(title), "", *_INTRODUCTION]
    for module in ("labcal.pipeline", "labcal"):
        heading = f"``{module}``"
        lines += [
            heading,
            "-" * len(heading),
            "",
            f".. currentmodule:: {module}",
            "",
            ".. list-table::",
            "   :widths: 30 70",
            "",
        ]
        for name, one in names.items():
            if name.rpartition(".")[0] == module:
                role = "class" if inspect.isclass(one) else "func"
                lines += [f"   * - :py:{role}:`~{name}`", f"     - {_first_line(one)}"]
        lines += [""]
    return "\n".join([*lines, ".. toctree::", "   :hidden:", "   :glob:", "", "   labcal.*", ""])


_INTRODUCTION = (
    "What a verb of the command line does is the function of its name in :mod:`!labcal.pipeline`. The",
    "package :mod:`!labcal` has the objects that these functions take and return. Lengths are millimetres,",
    "pixels are counted from the centre of the top-left one; :doc:`/conventions` has the rest.",
    "",
)


def _first_line(one: object) -> str:
    """Return the first paragraph of a docstring on one line."""
    return " ".join(inspect.getdoc(one).split("\n\n")[0].split())


def setup(app: Sphinx) -> dict[str, bool]:
    """Write the pages when the builder starts."""
    app.connect("builder-inited", write_pages)
    return {"parallel_read_safe": True}
