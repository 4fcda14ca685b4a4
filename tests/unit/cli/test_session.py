import io

import pytest

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
