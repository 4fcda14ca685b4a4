from pathlib import Path

import numpy as np
import pytest

from labcal.correspond.sources import Source, find_sources, loose_sources, parse_camera_endings
from labcal.errors import InputError
from labcal.shoot.pictures import write_picture


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    for name in ("b_1.png", "b_0.png", "a_0.png", "notes.txt"):
        (tmp_path / name).write_bytes(b"x")
    return tmp_path


def test_endings_name_the_cameras(folder: Path) -> None:
    found = loose_sources([str(folder)], parse_camera_endings("_0=left,_1=right"))
    assert [(s.view, s.camera, Path(s.image).name) for s in found] == [
        ("a", "left", "a_0.png"),
        ("b", "left", "b_0.png"),
        ("b", "right", "b_1.png"),
    ]
    assert all(source.size is None for source in found)


def test_without_endings_there_is_one_camera(folder: Path) -> None:
    found = find_sources([str(folder / "b_1.png"), str(folder / "a_0.png")], {})
    assert [(s.view, s.camera) for s in found] == [("a_0", "camera"), ("b_1", "camera")]
    assert found[0].image == str(folder / "a_0.png")  # as given


def test_the_longest_ending_counts(folder: Path) -> None:
    found = loose_sources([str(folder / "b_1.png")], {"1": "short", "_1": "long"})
    assert (found[0].view, found[0].camera) == ("b", "long")


@pytest.mark.parametrize("text", ["", "_0", "_0=", "=left", "_0=left,", "_0=left_cam", "_0=a,_0=b", "_0=a b"])
def test_endings_of_another_form_are_refused(text: str) -> None:
    with pytest.raises(InputError, match="_0=left,_1=right"):
        parse_camera_endings(text)


def test_what_names_no_picture_is_refused(folder: Path) -> None:
    with pytest.raises(InputError, match="There is no picture or folder"):
        loose_sources([str(folder / "c.png")], {})
    with pytest.raises(InputError, match=r"a_0\.png ends in none of _2"):
        loose_sources([str(folder)], {"_2": "left"})
    (folder / "empty").mkdir()
    with pytest.raises(InputError, match=r"There are no pictures \(\.bmp"):
        loose_sources([str(folder / "empty")], {})
    for name in ("a.fits", "b.FITS", "notes"):
        (folder / "empty" / name).write_bytes(b"x")
    with pytest.raises(InputError, match=r"empty: the files there are 2 \.fits, 1 without an ending\."):
        loose_sources([str(folder / "empty")], {})
    with pytest.raises(InputError, match=r"both view 'b' of camera 'left'.*`cameras="):
        loose_sources([str(folder)], {"_0": "left", "_1": "left"})


def test_a_picture_of_another_size_is_refused(tmp_path: Path) -> None:
    write_picture(tmp_path / "a.png", np.zeros((30, 40), dtype=np.uint8))
    assert Source("a", "left", str(tmp_path / "a.png"), (40, 30)).read().shape == (30, 40)
    with pytest.raises(InputError, match="is 40 x 30, but the shoot states that camera 'left' takes 30 x 40"):
        Source("a", "left", str(tmp_path / "a.png"), (30, 40)).read()


def cameras_of(folder: Path, names: list[str], cameras: str) -> dict[tuple[str, str], str]:
    """Return the name of each picture by view and camera."""
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).write_bytes(b"x")
    found = loose_sources([str(folder)], parse_camera_endings(cameras))
    return {(one.view, one.camera): str(Path(one.image).relative_to(folder)) for one in found}


@pytest.mark.parametrize(
    ("form", "cameras"),
    [
        ("take_{view}_eye{camera}_raw.png", "take_{view}_eye{camera}_raw"),
        ("{camera}_{view}.png", "{camera}_{view}"),
        ("{view}-{camera}.png", "{view}-{camera}"),
        ("{camera}/{view}.png", "{camera}/{view}"),
        ("{camera}/{view}.png", "{camera}/*"),
        ("{camera}/data/im{view}.png", "{camera}/data/im{view}"),
        ("x_{view}_{camera}_y.png", "x_{view}_N_y=N,x_{view}_S_y=S"),
        ("-{camera}-{view}.png", "-{camera}-{view}"),
    ],
)
def test_one_pattern_with_named_parts_tells_all_cameras(tmp_path: Path, form: str, cameras: str) -> None:
    wanted = {(v, c): form.format(view=v, camera=c) for v in ("07", "12", "30") for c in ("N", "S")}
    assert cameras_of(tmp_path, list(wanted.values()), cameras) == wanted


@pytest.mark.parametrize(
    "text", ["{camera}", "a_{camera}_b", "{camera}_{camera}_{view}", "{view}{camera}", "*{camera}"]
)
def test_patterns_whose_parts_are_open_are_refused(text: str) -> None:
    with pytest.raises(InputError, match=r"\{camera\}"):
        parse_camera_endings(text)


def test_what_a_pattern_takes_for_a_camera_must_be_a_name(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"is called 'a b', but names of cameras"):
        cameras_of(tmp_path, ["a b_1.png"], "{camera}_{view}")
    with pytest.raises(InputError, match=r"a b_1\.png fits none of \{camera\}-\{view\}"):
        cameras_of(tmp_path, ["a b_1.png"], "{camera}-{view}")


def test_pictures_may_lie_in_a_folder_of_the_folder_of_each_camera(tmp_path: Path) -> None:
    names = [f"cam{camera}/data/{view}.png" for camera in (0, 1) for view in ("100", "200", "300")]
    found = cameras_of(tmp_path, names, "cam0/data/*=left,cam1/data/*=right")
    assert found["200", "right"] == "cam1/data/200.png"
    with pytest.raises(InputError, match=r"those of 2 cameras .*`cameras='"):
        loose_sources([str(tmp_path)], {})
