"""The command line tells the library's messages with options in place of arguments."""

import ast
import inspect
import io
import json
import re
from dataclasses import dataclass
from pathlib import Path

import pytest

import labcal
from labcal import pipeline
from labcal.cli import VERBS, build_parser
from labcal.cli.option_words import OPTIONS, SWITCHES, document_in_options, in_options
from labcal.cli.session import Session
from labcal.cli.streams import Stream
from labcal.targets.artwork import export_artwork

LIBRARY = Path(labcal.__file__).parent


@pytest.mark.parametrize(
    ("message", "told"),
    [
        ("Add `force=True` to replace it.", "Add --force to replace it."),
        ("Try `lens='auto'` or `dot_places='freed'`.", "Try --lens auto or --free-dots."),
        ("Keep them: `dot_places='declared'`.", "Keep them: --keep-dots."),
        ("Say it: `size='1280x960'`.", "Say it: --size 1280x960."),
        ("Leave `hold_out` out.", "Leave --hold-out out."),
        ("Apart: `cameras='L/*=left,R/*=right'`.", "Apart: --cameras 'L/*=left,R/*=right'."),
        ("`from_format='ros'` or `hold_out=2`", "--from ros or --hold-out 2"),
        ("runs/size=3/a.png and seed=0 cannot be read", "runs/size=3/a.png and seed=0 cannot be read"),
        ("`lenses='fixed'` keeps them; `rehearsal=False`", "--fix-intrinsics keeps them; --no-rehearsal"),
        ("`no_such_option=3` stays", "`no_such_option=3` stays"),
    ],
)
def test_arguments_become_options(message: str, told: str) -> None:
    assert in_options(message) == told


def test_only_messages_in_a_document_are_changed() -> None:
    tree = {"image": "`force=True`", "warnings": ["`force=True`"], "error": {"message": "`size`"}}
    assert document_in_options(tree) == {
        "image": "`force=True`",
        "warnings": ["--force"],
        "error": {"message": "--size"},
    }


@dataclass(frozen=True)
class Document:
    file: str
    warnings: tuple[str, ...]


@pytest.mark.parametrize("as_json", [True, False])
def test_a_session_speaks_of_options(as_json: bool, capsys: pytest.CaptureFixture[str]) -> None:  # noqa: FBT001
    stream: Stream = io.StringIO()
    session = Session(stream, json=as_json)
    session.warn("Leave `lens` out.")
    session.emit(Document("a", ("Give `unit='m'`.",)), "Give `unit='m'`.")
    assert capsys.readouterr().err == "warning: Leave --lens out.\n"
    told = stream.getvalue()
    assert (json.loads(told)["warnings"] == ["Give --unit m."]) if as_json else (told == "Give --unit m.\n")


def options() -> set[str]:
    """Return the options of all verbs."""
    every = set()
    for verb in VERBS:
        (commands,) = build_parser(verb)._subparsers._group_actions  # type: ignore[union-attr]
        for parser in commands.choices.values():  # type: ignore[union-attr]
            groups = [parser]
            if parser._subparsers is not None:
                groups += parser._subparsers._group_actions[0].choices.values()
            every |= {option for group in groups for option in group._option_string_actions}
    return every


def test_every_option_is_one_of_a_verb() -> None:
    assert {*OPTIONS.values(), *SWITCHES.values()} <= options()


def arguments() -> set[str]:
    """Return the names of all arguments of public functions, methods and settings."""
    public = [getattr(home, name) for home in (labcal, pipeline) for name in home.__all__]
    methods = [one for kind in public if inspect.isclass(kind) for one in vars(kind).values()]
    methods = [getattr(one, "__func__", one) for one in methods]
    calls = [one for one in (*public, *methods, export_artwork) if callable(one)]
    return {name for call in calls for name in inspect.signature(call).parameters}


def test_options_stand_for_arguments() -> None:
    switches = {switch.partition("=")[0] for switch in SWITCHES}
    assert {*OPTIONS, *switches} <= arguments()


def test_every_argument_that_a_message_names_is_one() -> None:
    named = re.compile(r"`([a-z_]+)(?:=(?:True|False|'[^'`]*'|[\w.]+))?`")
    known = arguments() | {"table"}  # an attribute of DotSource
    found = []
    for path in LIBRARY.rglob("*.py"):
        tree = ast.parse(path.read_text(encoding="utf-8"))
        for text in messages(tree):
            found += [(path.name, name) for name in named.findall(text) if name not in known]
    assert found == []


def messages(tree: ast.Module) -> list[str]:
    """Return the texts of a file that are no docstrings, of attributes neither."""
    docs = {
        id(statement.value)
        for node in ast.walk(tree)
        if not isinstance(node, ast.Lambda | ast.IfExp)
        for statement in getattr(node, "body", [])
        if isinstance(statement, ast.Expr)
    }
    return [
        node.value
        for node in ast.walk(tree)
        if isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in docs
    ]


def test_no_message_of_the_library_speaks_of_an_option() -> None:
    long = [option for option in options() if option.startswith("--")]
    option = re.compile(rf"(?<![\w(-])(?:{'|'.join(map(re.escape, long))})(?![\w-])")
    rooms = [
        path for path in LIBRARY.rglob("*.py") if path.relative_to(LIBRARY).parts[0] not in ("cli", "bench")
    ]
    found = []
    for path in rooms:
        tree = ast.parse(path.read_text(encoding="utf-8"))
        documented = (ast.Module, ast.ClassDef, ast.FunctionDef)
        docs = [
            node.body[0].value
            for node in ast.walk(tree)
            if isinstance(node, documented) and ast.get_docstring(node)
        ]
        found += [
            (str(path.relative_to(LIBRARY)), node.value)
            for node in ast.walk(tree)
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and node not in docs
            if option.search(node.value) and "``" not in node.value
        ]
    # The command on the page of a twin, titles of tables for people, and what marks a folder of overlays.
    assert sorted((path, option.findall(text)[0]) for path, text in found) == [
        ("pipeline/twin.py", "--cameras"),
        ("pipeline/twin.py", "--dots"),
        ("pipeline/twin.py", "--raw"),
        ("pipeline/twin.py", "--target"),
        ("report/bench.py", "--quick"),
        ("report/calibrate_result.py", "--json"),
        ("report/mark_overlays.py", "--overlay"),
        ("report/overlays.py", "--overlay"),
    ]
