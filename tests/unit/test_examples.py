"""Every public name has an example, and every example is right."""

import doctest
import inspect
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
# This list may only shrink: a name that gets an example must be taken out, and no new name may join.
WITHOUT = {
    "labcal.Camera",
    "labcal.Detections",
    "labcal.FittedModel",
    "labcal.ReconstructedPoints",
    "labcal.Rig",
    "labcal.Shoot",
    "labcal.load_model",
    "labcal.open_shoot",
    "labcal.read_detections",
    "labcal.read_points",
    "labcal.read_rig",
    "labcal.save_model",
    "labcal.write_rig",
    "labcal.pipeline.calibrate",
    "labcal.pipeline.detect",
    "labcal.pipeline.detections_of",
    "labcal.pipeline.epipolar_rms",
    "labcal.pipeline.evaluate",
    "labcal.pipeline.fit",
    "labcal.pipeline.measure",
    "labcal.pipeline.reconstruct",
    "labcal.pipeline.render",
    "labcal.pipeline.taught",
    "labcal.pipeline.training_of",
}


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


def _failures(test: doctest.DocTest) -> str:
    """What is wrong in an example, as doctest tells it; empty where it is right."""
    told: list[str] = []
    doctest.DocTestRunner(optionflags=OPTIONS, verbose=False).run(test, out=told.append)
    return "".join(told)


@pytest.fixture(autouse=True)
def own_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """An empty current folder: an example may write there."""
    monkeypatch.chdir(tmp_path)


@pytest.mark.parametrize("name", sorted(PUBLIC.keys() - WITHOUT))
def test_a_public_name_has_an_example_that_is_right(name: str) -> None:
    one = PUBLIC[name]
    assert ">>> " in (inspect.getdoc(one) or ""), f"{name} has no example"
    tests = list(_examples(one))
    assert tests, f"{name} has an example that doctest does not find"
    assert "".join(map(_failures, tests)) == ""


@pytest.mark.parametrize("name", sorted(WITHOUT))
def test_a_name_on_the_list_of_those_without_belongs_there(name: str) -> None:
    assert name in PUBLIC, f"{name} is no public name any more: take it off the list"
    assert ">>> " not in (inspect.getdoc(PUBLIC[name]) or ""), f"{name} has an example: take it off the list"


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
