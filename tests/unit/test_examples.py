"""Every public name has an example, and every example is right."""

import doctest
import inspect
import re
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import pytest

import labcal
from labcal import pipeline

PROJECT = Path(__file__).parents[2]
PAGES = sorted(
    path
    for folder in ("how-to", "explanation", "reference")
    for path in (PROJECT / "docs" / folder).glob("*.md")
    if "\n>>> " in path.read_text(encoding="utf-8")
)
OPTIONS = doctest.NORMALIZE_WHITESPACE | doctest.ELLIPSIS
RENDERS = {
    "labcal.pipeline.bench",
    "labcal.pipeline.render",
    "labcal.pipeline.reproduce",
    "labcal.pipeline.twin",
    "labcal.twin",
}
"""Functions whose examples are shown and not run, since they render for minutes; other tests run them."""
WAITS = {"labcal.pipeline.capture_live"}
"""The same, since they wait for a person."""


def _public() -> dict[str, object]:
    """Public objects by their full names; modules and texts are none."""
    found = {f"labcal.{name}": getattr(labcal, name) for name in labcal.__all__}
    found |= {f"labcal.pipeline.{name}": getattr(pipeline, name) for name in pipeline.__all__}
    return {name: one for name, one in found.items() if callable(one) and not isinstance(one, ModuleType)}


PUBLIC = _public()


def _examples(one: object) -> Iterator[doctest.DocTest]:
    """Examples of an object's docstring and, of a class, of its methods."""
    module = inspect.getmodule(one)
    for test in doctest.DocTestFinder(exclude_empty=True).find(one, module=module, globs={}):
        if test.examples:
            yield test


EXAMPLES = [test for name in sorted(PUBLIC) for test in _examples(PUBLIC[name])]


def _failures(test: doctest.DocTest) -> str:
    """What is wrong in an example, as doctest tells it; empty where it is right."""
    told: list[str] = []
    doctest.DocTestRunner(optionflags=OPTIONS, verbose=False).run(test, out=told.append)
    return "".join(told)


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty current folder: an example may write there."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", sorted(PUBLIC))
def test_a_public_name_has_an_example(name: str) -> None:
    assert ">>> " in (inspect.getdoc(PUBLIC[name]) or ""), f"{name} has no example"
    tests = list(_examples(PUBLIC[name]))
    assert tests, f"{name} has an example that doctest does not find"


@pytest.mark.parametrize("test", EXAMPLES, ids=lambda test: test.name)
def test_an_example_of_a_public_name_is_right(test: doctest.DocTest) -> None:
    for package in ("pandas", "xarray"):
        if test.name.endswith(f".to_{package}"):
            pytest.importorskip(package)
    assert _failures(test) == ""


FUNCTIONS = sorted(name for name, one in PUBLIC.items() if inspect.isfunction(one))


@pytest.mark.parametrize("name", FUNCTIONS)
def test_a_public_function_says_what_it_takes_returns_and_raises(name: str) -> None:
    sections = _sections(inspect.getdoc(PUBLIC[name]) or "")
    signature = inspect.signature(PUBLIC[name])
    described = re.findall(r"^(\w[\w, ]*)(?: :|$)", sections.get("Parameters", ""), flags=re.MULTILINE)
    assert set(", ".join(described).split(", ")) == set(signature.parameters)
    assert ("Returns" in sections) == (signature.return_annotation is not None)
    assert "Raises" in sections or name == "labcal.pipeline.fit_methods"  # it returns its errors


def _sections(text: str) -> dict[str, str]:
    """Return the sections of a docstring by their titles."""
    parts = re.split(r"^(\w+)\n-+\n", text, flags=re.MULTILINE)
    return dict(zip(parts[1::2], parts[2::2], strict=True))


def test_only_functions_that_render_or_wait_have_an_example_that_is_not_run() -> None:
    skipping = {
        name
        for name, one in PUBLIC.items()
        for test in _examples(one)
        if any(example.options.get(doctest.SKIP) for example in test.examples)
    }
    assert skipping == RENDERS | WAITS


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_an_example_on_a_page_is_right(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    test = doctest.DocTestParser().get_doctest(text, {}, page.stem, str(page), 0)
    assert _failures(test) == ""


def _wrong() -> None:
    """Have an example that is wrong.

    >>> 1 + 1
    3
    """


def test_a_wrong_example_is_told() -> None:
    (test,) = _examples(_wrong)
    assert "Expected" in _failures(test)
