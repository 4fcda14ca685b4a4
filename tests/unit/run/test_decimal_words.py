"""Numbers are decimal in descriptions and in tables, whatever Python and YAML 1.1 take for numbers."""

from pathlib import Path

import pytest

from labcal import examples, read_detections
from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.run.yaml_reading import yaml_content


@pytest.mark.parametrize("word", ["010", "0x10", "0b11", "1_0", "1:30", "1_0.5", "1:30.5"])
def test_numbers_that_yaml_takes_for_others_are_refused(word: str) -> None:
    with pytest.raises(InputError, match="is not decimal"):
        yaml_content(f"cols: {word}", "a.yaml")


def test_decimal_numbers_of_yaml() -> None:
    text = "[1, -2, +3, 0, 0.5, .5, 2., 1.5e+10, -1.0e-3, .inf, 09.5]"
    assert yaml_content(text, "a") == [1, -2, 3, 0, 0.5, 0.5, 2.0, 1.5e10, -1e-3, float("inf"), 9.5]


@pytest.mark.parametrize("word", ["1_0", "\u0661", "1,5", "", "\x1c1.5", "\x0b1.5", "1.5\x0c", "\u00a01.5"])
def test_words_that_are_no_numbers(word: str) -> None:
    with pytest.raises(ValueError, match=r".*"):
        decimal(word)


@pytest.mark.parametrize("word", ["1.5", " 1.5", "1.5\t", "1.5\r\n", "+1.5e0"])
def test_words_that_are_numbers(word: str) -> None:
    assert decimal(word) == 1.5


@pytest.mark.parametrize("word", ["1_0", "\u0661\u0662"])
def test_tables_name_the_line_of_such_a_number(word: str, tmp_path: Path) -> None:
    path = tmp_path / "dots.csv"
    examples.detections().save(path)
    lines = path.read_text().splitlines()
    cells = lines[3].split(",")
    for at in (5, 7):  # a whole number, and another one
        lines[3] = ",".join([*cells[:at], word, *cells[at + 1 :]])
        path.write_text("\n".join(lines) + "\n")
        with pytest.raises(InputError, match=f"Line 4 .*'{word}' is no"):
            read_detections(path)
