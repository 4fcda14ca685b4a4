from pathlib import Path

import pytest

from labcal.errors import InputError, UnknownNameError
from labcal.run.descriptions import description_names, parse_yaml, read_description
from labcal.targets.grid import DotGrid

SHIPPED = Path(__file__).parents[3] / "calib_targets"


def read(name: str) -> DotGrid:
    return read_description(DotGrid, "target", "calib_targets", name)


def changed(tmp_path: Path, old: str, new: str) -> str:
    """Write a shipped description with one thing changed and return its path."""
    text = (SHIPPED / "rings-10x8.yaml").read_text(encoding="utf-8")
    assert old in text
    path = tmp_path / "mine.yaml"
    path.write_text(text.replace(old, new), encoding="utf-8")
    return str(path)


def test_every_shipped_description_is_found_and_bears_the_name_of_its_file() -> None:
    names = description_names("calib_targets")
    assert names == sorted(path.stem for path in SHIPPED.glob("*.yaml"))
    assert [read(name).name for name in names] == names


def test_a_file_of_ones_own_is_read_by_its_path(tmp_path: Path) -> None:
    assert read(changed(tmp_path, "cols: 10", "cols: 11")).cols == 11


@pytest.mark.parametrize(
    ("old", "new", "said"),
    [
        ("cols: 10", "cols: 10\ncolour: red", "colour: this key is not known"),
        ("cols: 10\n", "", "cols: this key is missing"),
        ("cols: 10", "cols: many", "cols: Input should be a valid integer"),
        ("pitch_x_mm: 3.5", "pitch_x_mm: .nan", "pitch_x_mm"),
        ("pitch_x_mm: 3.5", "pitch_x_mm: -1", "pitch_x_mm: -1 should be more than 0"),
        ("polarity: black-on-white", "polarity: black-on-whit", "(did you mean 'black-on-white'?)"),
        ("origin: [2, 2]", "origin: [2, 3]", "x ring must lie in the row"),
    ],
)
def test_a_fault_is_told_with_its_key(old: str, new: str, said: str, tmp_path: Path) -> None:
    path = changed(tmp_path, old, new)
    with pytest.raises(InputError) as raised:
        read(path)
    assert said in str(raised.value)
    assert path in str(raised.value)


def test_every_fault_is_told(tmp_path: Path) -> None:
    path = changed(tmp_path, "cols: 10\nrows: 8", "cols: 1\nrow: 8")
    with pytest.raises(InputError, match=r"(?s)cols.*rows.*row: this key"):
        read(path)


def test_a_misspelled_name_offers_the_nearest() -> None:
    with pytest.raises(
        UnknownNameError, match=r"no target named 'paper-13x11'. Did you mean 'paper-13x10'\?"
    ):
        read("paper-13x11")


def test_a_missing_file_and_a_folder_are_told(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"missing\.yaml cannot be read"):
        read(str(tmp_path / "missing.yaml"))
    (tmp_path / "folder.yaml").mkdir()
    with pytest.raises(InputError, match=r"folder\.yaml cannot be read"):
        read(str(tmp_path / "folder.yaml"))


def test_a_picture_is_no_description(tmp_path: Path) -> None:
    path = tmp_path / "picture.yaml"
    path.write_bytes(b"\x89PNG\r\n\x1a\n\xff\xfe")
    with pytest.raises(InputError, match="cannot be read"):
        read(str(path))


@pytest.mark.parametrize("text", ["a: [1", "- 1\n- 2", "", "just text"])
def test_what_is_no_mapping_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="mine"):
        parse_yaml(text, "mine")


def test_a_description_cannot_run_code() -> None:
    with pytest.raises(InputError, match="not valid YAML"):
        parse_yaml("a: !!python/object/apply:os.system ['true']", "mine")
