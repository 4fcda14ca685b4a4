"""Links between the files of the project lead somewhere, also where the site does not look: README and CI."""

import re
from pathlib import Path

import pytest

PROJECT = Path(__file__).parents[2]
PAGES = sorted(
    path
    for path in (*PROJECT.glob("*.md"), *(PROJECT / "docs").rglob("*.md"))
    if not {"_build", "auto_tutorials", "commands"} & set(path.parts)
)
# Between brackets and parentheses; code is cut out first.
LINK = re.compile(r"\]\(([^)\s]+)\)")
CODE = re.compile(r"```.*?```|`[^`\n]*`", re.DOTALL)
MADE = ("auto_tutorials/", "reference/api/", "reference/commands/")
"""Folders of pages that are made when the site is built."""
NAMED = re.compile(r"docs/[\w./-]+\.(?:md|py)")


def _anchor(heading: str) -> str:
    """The anchor that GitHub and MyST give a heading."""
    return re.sub(r"[^\w\- ]", "", heading.strip().lower()).replace(" ", "-")


def _anchors(page: Path) -> set[str]:
    return {
        _anchor(line.lstrip("#")) for line in page.read_text(encoding="utf-8").splitlines() if line[:1] == "#"
    }


def _dead(page: Path) -> list[str]:
    """Links of a page to files or headings that are not there."""
    dead = []
    for link in LINK.findall(CODE.sub("", page.read_text(encoding="utf-8"))):
        path, _, anchor = link.partition("#")
        if "://" in link or link.startswith("mailto:") or any(made in path for made in MADE):
            continue
        to = (page.parent / path).resolve() if path else page
        if not to.exists() or (anchor and anchor not in _anchors(to)):
            dead.append(link)
    return dead


@pytest.mark.parametrize("page", PAGES, ids=lambda page: str(page.relative_to(PROJECT)))
def test_links_of_a_page_lead_somewhere(page: Path) -> None:
    assert _dead(page) == []


def test_files_of_docs_that_code_names_are_there() -> None:
    sources = [*(PROJECT / "labcal").rglob("*.py"), PROJECT / "README.md", PROJECT / "CONTRIBUTING.md"]
    named = {name for source in sources for name in NAMED.findall(source.read_text(encoding="utf-8"))}
    assert named, "nothing is named: the pattern is wrong"
    assert sorted(name for name in named if not (PROJECT / name).exists()) == []


def test_a_dead_link_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# A title\n[here](#a-title) [there](#another) [gone](gone.md) `[code](x.md)`\n")
    assert _dead(page) == ["#another", "gone.md"]
