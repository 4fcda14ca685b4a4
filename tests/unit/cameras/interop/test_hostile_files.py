"""Damaged, truncated and hostile files are refused in plain words, quickly, and nothing else happens."""

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from labcal.cameras.interop.exchange import Home
from labcal.cameras.interop.registry import FORMATS, format_to_write
from labcal.cameras.interop.rig_files import read_rig_files
from labcal.cameras.interop.xml_tree import read_xml_tree
from labcal.cameras.interop.yaml_tree import read_yaml_tree
from labcal.cameras.rig import Rig
from labcal.errors import InputError, UnknownNameError

MakeRig = Callable[..., Rig]
SOURCE = Path("file")
LAUGHS = "a: &a [x, x, x, x, x, x, x, x, x]\n" + "".join(
    f"{after}: &{after} [*{before}, *{before}, *{before}, *{before}]\n"
    for before, after in zip("abcdefgh", "bcdefghi", strict=True)
)
ENTITIES = '<!DOCTYPE x [<!ENTITY a "ha"><!ENTITY b "&a;&a;">]><opencv_storage><K>&b;</K></opencv_storage>'


@pytest.mark.parametrize(
    "text",
    [
        LAUGHS,
        "a: !!python/object/apply:os.system ['true']",
        "a: [" * 3000,
        "{" * 50000,
        "a: 'open",
        "- 1",
        "",
        "? [1]\n: 2",
        "a: 2001-99-99",
    ],
)
def test_yaml_that_is_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"YAML|keys with values"):
        read_yaml_tree(text, SOURCE)


@pytest.mark.parametrize(
    "text",
    [
        ENTITIES,
        '<!DOCTYPE x SYSTEM "file:///etc/passwd" [<!ENTITY a SYSTEM "file:///etc/passwd">]><x>&a;</x>',
        '<!DOCTYPE x [<!ENTITY % p SYSTEM "http://127.0.0.1/x">%p;]><x/>',
        "<a>" * 5000,
        "<a><b></a>",
        "<a/>more",
        "",
        "<a>\0</a>",
    ],
)
def test_xml_that_is_refused(text: str) -> None:
    with pytest.raises(InputError, match="is not XML"):
        read_xml_tree(text, SOURCE)


def test_a_bare_document_type_does_no_harm() -> None:
    assert read_xml_tree("<!DOCTYPE vpml><project/>", SOURCE).tag == "project"


@pytest.mark.parametrize("nested", ["(" * 10000, "-" * 200000 + "1", "[" * 150 + "]" * 150, "{'a': 1 +"])
def test_nested_literals_of_mrcal_are_refused(tmp_path: Path, nested: str) -> None:
    path = tmp_path / "a.cameramodel"
    path.write_text(f"{{'lensmodel': 'LENSMODEL_PINHOLE', 'intrinsics': {nested}")
    with pytest.raises(InputError, match="mrcal"):
        read_rig_files([path], "mrcal")


@pytest.mark.parametrize("name", list(FORMATS))
@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 0.9])
def test_a_truncated_file_is_refused(tmp_path: Path, make_rig: MakeRig, name: str, share: float) -> None:
    chosen = FORMATS[name]
    paths = []
    for file in chosen.write(make_rig("brown-k1k2"), chosen.suffixes[0]).files:
        in_folder = chosen.home is Home.FOLDER
        path = tmp_path / (file.label if in_folder else f"{file.label or 'rig'}{chosen.suffixes[0]}")
        content = file.text.rstrip().encode() if isinstance(file.text, str) else file.text
        path.write_bytes(content[: int(share * len(content))])
        paths.append(path)
    with pytest.raises(InputError):
        read_rig_files(paths, name)


@pytest.mark.parametrize("name", list(FORMATS))
@pytest.mark.parametrize("value", [b"\xff\xfe\x00a", b"\x00" * 40, b"[1, 2]", b"cam0: {}\n", b"<a/>", b"{}"])
def test_files_of_something_else_are_refused(tmp_path: Path, name: str, value: bytes) -> None:
    path = tmp_path / "cameras.txt"
    path.write_bytes(value)
    with pytest.raises(InputError):
        read_rig_files([path], name)
    with pytest.raises(InputError, match=r"of no format|no text file"):
        read_rig_files([path], None)


def test_files_that_are_too_large_missing_or_no_files(tmp_path: Path) -> None:
    path = tmp_path / "large.yaml"
    with path.open("wb") as handle:
        os.truncate(handle.fileno(), 2**21)
    with pytest.raises(InputError, match="more than 131072 bytes"):
        read_rig_files([path], "kalibr")
    path.write_text("cam0:\n  distortion_model: [" + "1," * 2**17 + "]\n")
    with pytest.raises(InputError, match="more than 131072 bytes"):
        read_rig_files([path], None)
    with pytest.raises(InputError, match="cannot be read: No such file"):
        read_rig_files([tmp_path / "none.yaml"], None)
    os.mkfifo(tmp_path / "pipe.yaml")
    with pytest.raises(InputError, match="it is no file"):
        read_rig_files([tmp_path / "pipe.yaml"], None)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match="no file of any format"):
        read_rig_files([tmp_path / "empty"], None)


def test_a_camera_model_that_is_large_for_its_inputs_is_read_and_no_other(
    tmp_path: Path, make_rig: MakeRig
) -> None:
    text = FORMATS["mrcal"].write(make_rig("pinhole", count=1), ".cameramodel").files[0].text
    path = tmp_path / "a.cameramodel"
    path.write_text(text.replace("}", "    'optimization_inputs': b'" + "x!" * 2**20 + "',\n}"))
    assert list(read_rig_files([path], None)[1].rig.cameras) == ["left"]
    path.write_text(text.replace("}", "    'more': [" + "1, " * 2**17 + "],\n}"))
    with pytest.raises(InputError, match="far more than a camera"):
        read_rig_files([path], None)


def test_names_and_endings() -> None:
    with pytest.raises(UnknownNameError, match="Did you mean 'kalibr'"):
        read_rig_files([SOURCE], "kalibra")
    assert format_to_write(Path("a.cameramodel")).name == "mrcal"
    with pytest.raises(InputError, match="`to_format='FORMAT'`, one of opencv, kalibr, ros"):
        format_to_write(Path("a.yaml"))
    with pytest.raises(InputError, match="`to_format='FORMAT'`, one of opencv, dice"):
        format_to_write(Path("a.xml"))


def test_files_of_two_formats_are_not_one_rig(tmp_path: Path, make_rig: MakeRig) -> None:
    for name in ("kalibr", "mrcal"):
        chosen = FORMATS[name]
        text = chosen.write(make_rig("pinhole", count=1), chosen.suffixes[0]).files[0].text
        (tmp_path / f"a{chosen.suffixes[0]}").write_text(text)
    with pytest.raises(InputError, match="several formats: mrcal, kalibr"):
        read_rig_files([tmp_path], None)
    assert list(read_rig_files([tmp_path / "a.yaml"], None)[1].rig.cameras) == ["left"]


@pytest.mark.parametrize("space", [b"\x85", b"\xa0", b"\x1c", "\u2028".encode(), "\u00a0".encode()])
@pytest.mark.parametrize("name", ["opencv", "kalibr", "ros"])
def test_a_minus_sign_is_not_lost_as_a_space(
    name: str, space: bytes, make_rig: MakeRig, tmp_path: Path
) -> None:
    chosen = FORMATS[name]
    files = chosen.write(make_rig("brown-k1k2" if name == "kalibr" else "brown5"), chosen.suffixes[0]).files
    for number, file in enumerate(files):
        text = file.text if isinstance(file.text, bytes) else file.text.encode()
        damaged = text.replace(b"-0.", space + b"0.", 1)
        (tmp_path / f"{number}{chosen.suffixes[0]}").write_bytes(damaged if number == 0 else text)
        assert number > 0 or damaged != text
    with pytest.raises(InputError):
        read_rig_files([tmp_path / f"{n}{chosen.suffixes[0]}" for n in range(len(files))], name)
