import io
import json

import pytest
from rich.table import Table

from labcal.cli.progress import RichProgress
from labcal.cli.session import Session
from labcal.run.progress import NoProgress


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_quiet_silences_messages_but_not_warnings(capsys: pytest.CaptureFixture[str]) -> None:
    session = Session(io.StringIO(), quiet=True)
    session.say("a message")
    session.warn("a warning")
    assert capsys.readouterr().err == "warning: a warning\n"


def test_text_is_told_as_it_is(capsys: pytest.CaptureFixture[str]) -> None:
    text = "keep [bold]this[/bold] :smile: " + "word " * 60 + "end"
    Session(io.StringIO()).say(text)
    assert capsys.readouterr().err == text + "\n"


@pytest.mark.parametrize(
    ("stream", "quiet", "shown"),
    [(Terminal(), False, True), (Terminal(), True, False), (io.StringIO(), False, False)],
)
def test_a_bar_is_shown_only_to_a_person(
    stream: io.StringIO, *, quiet: bool, shown: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("sys.stderr", stream)
    with Session(io.StringIO(), quiet=quiet).progress() as progress:
        assert isinstance(progress, RichProgress if shown else NoProgress)
        progress.start("detecting", 3)
        progress.advance(3)
    assert ("detecting" in stream.getvalue()) == shown
    assert ("3/3" in stream.getvalue()) == shown


def test_a_bar_cannot_advance_before_it_starts(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("sys.stderr", Terminal())
    with Session(io.StringIO()).progress() as progress, pytest.raises(RuntimeError, match="before"):
        progress.advance()


def test_names_command_no_terminal(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Neither in a message nor in a cell of a table, which has codes of its own on a terminal."""
    name = "a\x1b[31m\x9b2J\u202ex.png"
    Session(io.StringIO()).warn(name)
    assert capsys.readouterr().err == "warning: a\\x1b[31m\\x9b2J\\u202ex.png\n"
    Session(io.StringIO()).fail("bad name 'a\nwarning: all is well'", {})
    assert capsys.readouterr().err == "error: bad name 'a warning: all is well'\n"
    monkeypatch.setenv("TERM", "xterm-256color")
    terminal = Terminal()
    table = Table("picture")
    table.add_row(name)
    Session(terminal).emit({}, table)
    shown = terminal.getvalue()
    assert "\x1b[1m" in shown  # the table's own
    assert "\x1b[31m" not in shown
    assert "\x9b" not in shown
    assert "\u202e" not in shown
    assert "\\x1b[31m\\x9b2J\\u202ex.png" in shown


def test_a_json_document_commands_no_terminal_and_says_the_same() -> None:
    stream = io.StringIO()
    name = "a\x1b[31m\x9b2J\u202e"
    Session(stream, json=True).emit({"name": name}, "")
    assert json.loads(stream.getvalue()) == {"name": name}
    assert not set(stream.getvalue()) & {"\x1b", "\x9b", "\u202e"}
