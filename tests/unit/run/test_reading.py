"""Files, YAML and JSON as they are read: nothing that never ends, unfolds, or says a thing twice."""

import os
import time
from pathlib import Path

import numpy as np
import pytest
from pydantic import BaseModel

from labcal.cameras.rig import Rig
from labcal.errors import InputError
from labcal.run.descriptions import explain_validation, parse_yaml
from labcal.run.documents import read_document
from labcal.run.file_reading import read_bytes, read_text
from labcal.run.json_reading import json_content
from labcal.run.tables import read_table, refuse_twice, table_text
from labcal.run.yaml_reading import yaml_content


class Kept(BaseModel):
    n: int
    names: tuple[int, ...] = ()


LAUGHS = "a0: &a0 [x, x]\n" + "".join(f"a{i}: &a{i} [*a{i - 1}, *a{i - 1}]\n" for i in range(1, 30))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (LAUGHS, "aliases"),
        ("a: " + "[" * 1000 + "]" * 1000, "nested more than"),
        ("a: " + "9" * 5000, "not valid YAML"),
        ("a: 2001-99-99", "month"),
        ("%", "not valid YAML"),
        ("a: 1\na: 2", "occurs twice"),
        ("b: {c: 1, c: 2}", "occurs twice"),
        ("<<: {a: 1}", "merge keys"),
        ('a: "\\ud83d\\ude00"', "surrogates"),
        ("a: !!python/object:os.system x", "not valid YAML"),
        ("a: \x1b[2J", "not valid YAML"),
    ],
)
def test_yaml_that_is_refused(text: str, said: str) -> None:
    with pytest.raises(InputError, match=said) as caught:
        yaml_content(text, "it")
    assert len(str(caught.value)) < 500


def test_yaml_that_is_read() -> None:
    assert parse_yaml("a: [1, {b: off}]\n", "it") == {"a": [1, {"b": False}]}


@pytest.mark.parametrize(
    "text", ['{"a": 1, "a": 2}', '{"a": NaN}', '{"a": -Infinity}', "[" * 100_000, "9" * 5000, "{"]
)
def test_json_that_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="not valid JSON"):
        json_content(text, "it")


def test_a_document_with_a_byte_order_mark_is_read_and_one_in_utf_16_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_bytes(b'\xef\xbb\xbf{"n": 1}')
    assert read_document(Kept, "thing", path) == Kept(n=1)
    path.write_bytes('{"n": 1}'.encode("utf-16"))
    with pytest.raises(InputError, match=r"it is a text in UTF-16\. Save it as UTF-8"):
        read_document(Kept, "thing", path)


def test_a_thousand_faults_are_told_as_a_few_and_a_number(tmp_path: Path) -> None:
    path = tmp_path / "a.json"
    path.write_text('{"n": 1, "names": [' + ", ".join(['"x"'] * 1005) + "]}")
    with pytest.raises(InputError, match="and 997 more") as caught:
        read_document(Kept, "thing", path)
    assert len(str(caught.value)) < 1500
    assert explain_validation.__doc__


def test_only_files_of_a_sensible_size_are_read(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    (tmp_path / "loop").symlink_to(tmp_path / "loop")
    (tmp_path / "large").write_bytes(bytes(101))
    for name, said in (
        ("pipe", "it is no file"),
        ("loop", "cannot be read"),
        ("none", "No such file"),
        (".", "Is a directory"),
        ("large", "more than 100 bytes"),
        ("a\0b", "cannot be read"),
    ):
        with pytest.raises(InputError, match=said):
            read_bytes(tmp_path / name, "thing", 100)
    with pytest.raises(InputError, match="it is no file"):
        read_text(Path("/dev/zero"), "thing", 100)
    with pytest.raises(InputError, match="more than 10 bytes"):  # says that it is empty
        read_bytes(Path("/proc/self/maps"), "thing", 10)


@pytest.mark.parametrize("name", ["=cmd()", "+1", "-1", "@SUM(1)", "\tx", "'=x", "''-x", "plain", "'quoted'"])
def test_texts_that_begin_as_formulas_are_none_and_come_back(name: str, tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text(table_text(("name", "x"), [[name, -1.5]]), newline="")
    assert list(read_table(("name", "x"), "things", path)) == [[name, "-1.5"]]
    cell = path.read_text().splitlines()[1].rpartition(",")[0].strip('"')
    assert cell[0] not in "=+-@\t\r"


def test_lines_of_the_same_thing_are_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"Line 4 of .* is of the same dot as line 2"):
        refuse_twice(tmp_path / "a.csv", np.array([[1], [2], [1]]), "dot")
    refuse_twice(tmp_path / "a.csv", np.array([[1], [2], [-1], [-1]]), "dot")


@pytest.mark.parametrize(
    ("data", "said"),
    [
        (b"\x89PNG\r\n\x1a\n\x00\x00", "it is a PNG picture, not a text"),
        (
            b"\x50\x00\x00\x00\x00\x00\x00\x00" + b'{"__metadata__":{}}\xff',
            "it is a model that 'labcal fit' wrote",
        ),
        ("gr\u00fcn".encode("latin-1"), "it is a text, but not in UTF-8. Save it as UTF-8"),
        ("gr\u00fcn".encode("utf-16"), "a text in UTF-16"),
        (b"\x00\x01\x02\xff", "it is a binary file, not a text"),
    ],
)
def test_what_is_no_text_is_told_by_its_kind(tmp_path: Path, data: bytes, said: str) -> None:
    (tmp_path / "a").write_bytes(data)
    with pytest.raises(InputError) as caught:
        read_text(tmp_path / "a", "thing", 1000)
    assert said in str(caught.value)
    assert "codec" not in str(caught.value)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("[1]", "is not a rig: it holds a list of 1, not a mapping of keys to values"),
        ('{"format": "labcal-shoot"}', "is not a rig: its 'format' is 'labcal-shoot', not 'labcal-rig'"),
        (
            '{"format": "labcal-rig", "format_version": 2}',
            "has format_version 2, but this labcal reads up to 1",
        ),
        ('{"format": "labcal-rig", "cameras": {}}', "cannot be used: cameras"),
        ('{"format": "labcal-rig", "cameras": {', "is not valid JSON"),
    ],
)
def test_what_a_document_is_not_and_what_is_wrong_with_it_are_told_apart(
    tmp_path: Path, text: str, said: str
) -> None:
    (tmp_path / "a.json").write_text(text)
    with pytest.raises(InputError) as caught:
        read_document(Rig, "rig", tmp_path / "a.json")
    assert said in str(caught.value)
    assert "that this version reads" not in str(caught.value)


def test_a_key_that_stands_twice_among_many_is_found_at_once() -> None:
    keys = [f'"{n}": 0' for n in range(40_000)]
    started = time.process_time()
    with pytest.raises(InputError, match="the key '39999' occurs twice"):
        json_content("{" + ", ".join([*keys, keys[-1]]) + "}", "a.json")
    assert time.process_time() - started < 3.0  # comparing each with all took over ten
