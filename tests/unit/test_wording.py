import json
import sys

import pytest

from labcal.errors import InputError, UnknownNameError
from labcal.wording import (
    MOST_LETTERS,
    counted,
    has_control,
    json_escaped,
    listed,
    printable,
    shortened,
    shown,
)


@pytest.mark.parametrize(
    ("text", "written"),
    [
        ("a\x1b[31mred", "a\\x1b[31mred"),
        ("\x9b2J", "\\x9b2J"),
        ("\x7f\r\x08", "\\x7f\\x0d\\x08"),
        ("\u202egnp.exe", "\\u202egnp.exe"),
        ("\udcff.png", "\\udcff.png"),
        ("two\nlines\tand more, é, 你", "two\nlines\tand more, é, 你"),
    ],
)
def test_what_commands_a_terminal_is_written_out(text: str, written: str) -> None:
    assert printable(text) == written


def test_json_says_the_same_when_escaped() -> None:
    said = ["\x1b[2J", "\x9b", "\u202e", "plain é"]
    escaped = json_escaped(json.dumps(said, ensure_ascii=False))
    assert json.loads(escaped) == said
    assert not has_control(escaped)
    assert "é" in escaped


def test_messages_are_bounded_and_keep_their_end() -> None:
    error = InputError("x" * 100_000 + " Mend it so.")
    assert len(str(error)) < MOST_LETTERS + 100
    assert str(error).endswith("Mend it so.")
    assert str(error).startswith("xxx")
    assert shortened("short") == "short"
    unknown = UnknownNameError("target", "y" * 100_000, [f"name-{i}" for i in range(10_000)])
    assert len(str(unknown)) < MOST_LETTERS
    assert "more" in str(unknown)


def test_values_are_shown_in_part() -> None:
    assert shown("a" * 500) == "'" + "a" * 79 + "..."
    assert shown([0] * 500) == "a list of 500"
    assert shown(1.5) == "1.5"
    assert "digits" in shown(10 ** (2 * sys.int_info.default_max_str_digits))
    assert listed([str(i) for i in range(1009)]).endswith("11 and 997 more")
    assert listed(["a", "b"]) == "a, b"


def test_numbers_agree_with_their_nouns() -> None:
    assert [counted(n, "view") for n in (0, 1, 2)] == ["0 views", "1 view", "2 views"]
    assert counted(2, "axis", "axes") == "2 axes"
