"""Every format gives back what it was given, to the last digit or to the rounding of a rotation."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.interop.conversion import ConvertSettings
from labcal.cameras.interop.exchange import Home, ReadOptions
from labcal.cameras.interop.registry import FORMATS
from labcal.cameras.interop.rig_files import read_rig_files, write_rig_files
from labcal.cameras.interop.understanding import understood_cameras
from labcal.cameras.lens import LENSES
from labcal.cameras.principal_point import exchanged_sides_note
from labcal.cameras.rig import Rig
from labcal.errors import InputError

MakeRig = Callable[..., Rig]
PERSPECTIVE = ("pinhole", "brown-k1k2", "brown5", "rational8", "thin-prism12", "tilted14")
HELD = {
    "labcal": tuple(LENSES),
    "opencv": (*PERSPECTIVE, "fisheye-kb4"),
    "mrcal": PERSPECTIVE[:-1],
    "kalibr": ("pinhole", "brown-k1k2", "fisheye-kb4", "double-sphere", "eucm", "omni-radtan"),
    "ros": ("pinhole", "brown-k1k2", "brown5", "rational8", "fisheye-kb4"),
    "colmap": ("pinhole", "brown-k1k2", "brown5", "rational8", "fisheye-kb4", "eucm"),
    "colmap-binary": ("pinhole", "brown-k1k2", "brown5", "rational8", "fisheye-kb4", "eucm"),
    "dice": PERSPECTIVE,
    "anipose": ("pinhole", "brown-k1k2", "brown5", "fisheye-kb4"),
    "matlab": ("pinhole", "brown-k1k2", "brown5"),
    "matchid": ("pinhole", "brown-k1k2", "brown5"),
}
"""The lenses that each format has."""
WITH_WORLD = ("labcal", "mrcal", "colmap", "colmap-binary", "dice", "anipose")
NAMELESS = {"matlab": "does not state the names", "matchid": "states neither the names"}
SHIFTED = ("colmap", "colmap-binary", "matlab")
"""Formats whose principal point is another number, so that it may lose its last digit."""
CASES = [(name, lens) for name, lenses in HELD.items() for lens in lenses]
MISSING = [(name, lens) for name, lenses in HELD.items() for lens in LENSES if lens not in lenses]


def there_and_back(
    rig: Rig, name: str, folder: Path, suffix: str | None = None
) -> tuple[Rig, tuple[str, ...]]:
    """Write a rig, read it by what the files hold, and return it with what was said about the writing."""
    chosen = FORMATS[name]
    suffix = suffix or chosen.suffixes[0]
    texts = chosen.write(rig, suffix)
    in_folder = chosen.home is Home.FOLDER
    path = folder / ("model" if in_folder else f"rig{suffix}")
    files = write_rig_files(path, chosen, texts, force=False)
    given = ReadOptions(size=(640, 480) if name == "matchid" else None)
    found, back = read_rig_files([path] if in_folder else files, None, given)
    assert found.name == name
    if name in NAMELESS:
        assert NAMELESS[name] in " ".join(texts.notes)
        renamed = dict(zip(rig.cameras, back.rig.cameras.values(), strict=True))
        return Rig(cameras=renamed), tuple(note for note in texts.notes if "world" in note)
    return back.rig, texts.notes


@pytest.mark.parametrize(("name", "lens"), CASES)
def test_a_rig_comes_back(name: str, lens: str, tmp_path: Path, make_rig: MakeRig) -> None:
    rig = make_rig(lens)
    back, notes = there_and_back(rig, name, tmp_path)
    assert notes == ()
    assert list(back.cameras) == list(rig.cameras)
    for camera, record in back.cameras.items():
        meant = rig.cameras[camera]
        assert (record.lens, record.size, record.dist) == (meant.lens, meant.size, meant.dist)
        # COLMAP's half pixel may cost the last digit; rotations become quaternions, vectors or products.
        np.testing.assert_allclose(record.K, meant.K, rtol=1e-15 if name in SHIFTED else 0.0, atol=0.0)
        np.testing.assert_allclose(record.T_cam_world, meant.T_cam_world, rtol=1e-14, atol=1e-15)


@pytest.mark.parametrize("name", ["labcal", "opencv", "dice"])
def test_what_is_written_as_it_is_comes_back_to_the_last_digit(
    name: str, tmp_path: Path, make_rig: MakeRig
) -> None:
    rig = make_rig("tilted14")
    assert there_and_back(rig, name, tmp_path)[0] == rig


def test_opencv_xml_comes_back_to_the_last_digit(tmp_path: Path, make_rig: MakeRig) -> None:
    rig = make_rig("fisheye-kb4")
    assert there_and_back(rig, "opencv", tmp_path, ".xml")[0] == rig


@pytest.mark.parametrize("count", [1, 3])
@pytest.mark.parametrize("name", ["opencv", "mrcal", "kalibr", "colmap", "colmap-binary", "dice", "anipose"])
def test_one_camera_and_three(name: str, count: int, tmp_path: Path, make_rig: MakeRig) -> None:
    rig = make_rig("brown-k1k2", count=count)
    back, _ = there_and_back(rig, name, tmp_path)
    assert list(back.cameras) == list(rig.cameras)
    for camera, record in back.cameras.items():
        np.testing.assert_allclose(record.T_cam_world, rig.cameras[camera].T_cam_world, atol=1e-12)


@pytest.mark.parametrize("name", list(HELD))
def test_another_world_is_kept_or_the_first_camera_becomes_it_and_that_is_said(
    name: str, tmp_path: Path, make_rig: MakeRig, elsewhere: np.ndarray
) -> None:
    rig = make_rig("brown-k1k2", elsewhere)
    back, notes = there_and_back(rig, name, tmp_path)
    to_world = np.eye(4) if name in WITH_WORLD else elsewhere
    assert bool(notes) is (name not in WITH_WORLD)
    assert all("first camera, 'left', is the world" in note for note in notes)
    for camera, record in back.cameras.items():
        expected = np.array(rig.cameras[camera].T_cam_world) @ np.linalg.inv(to_world)
        np.testing.assert_allclose(record.T_cam_world, expected, atol=1e-11)


@pytest.mark.parametrize(("name", "lens"), MISSING)
def test_a_lens_that_a_format_does_not_have_is_refused_by_name(
    name: str, lens: str, make_rig: MakeRig
) -> None:
    with pytest.raises(InputError, match=f"'{lens}' of camera 'left'"):
        FORMATS[name].write(make_rig(lens), FORMATS[name].suffixes[0])


def test_every_format_is_tried_with_every_lens() -> None:
    assert set(HELD) == set(FORMATS)
    assert len(CASES) + len(MISSING) == len(FORMATS) * len(LENSES)


MOST = {"ros": 2, "matlab": 2, "matchid": 2}
"""Cameras that a format holds, where it has a limit."""
MIXED = [
    (name, first, second)
    for name, lenses in HELD.items()
    for first, second in zip(lenses, (*lenses[1:], lenses[0]), strict=True)
]


@pytest.mark.parametrize(("name", "first", "second"), MIXED)
def test_unlike_cameras_come_back_or_are_refused_by_name(
    name: str, first: str, second: str, tmp_path: Path, make_rig: MakeRig
) -> None:
    """Three cameras (or as many as there may be) with two lenses and three sizes."""
    sizes = {"left": (640, 480), "right-2": (620, 470), "third": (600, 520)}
    records = {}
    for lens, camera in zip((first, second, first), list(sizes)[: MOST.get(name, 3)], strict=False):
        record = make_rig(lens, count=3).cameras[camera]
        records[camera] = record.model_copy(update={"size": sizes[camera]})
    rig = Rig(cameras=records)
    if name == "matchid":
        assert "640x480 and 620x470" in " ".join(FORMATS[name].write(rig, ".caldat").notes)
        return
    back, _ = there_and_back(rig, name, tmp_path)
    assert list(back.cameras) == list(rig.cameras)
    for camera, record in back.cameras.items():
        meant = rig.cameras[camera]
        assert (record.lens, record.size, record.dist) == (meant.lens, meant.size, meant.dist)
        np.testing.assert_allclose(record.K, meant.K, rtol=1e-15 if name in SHIFTED else 0.0, atol=0.0)
        np.testing.assert_allclose(record.T_cam_world, meant.T_cam_world, rtol=1e-12, atol=1e-13)


def test_a_pair_of_opencv_has_one_size_and_one_kind_of_lens(make_rig: MakeRig) -> None:
    one, other = make_rig("brown5").cameras["left"], make_rig("fisheye-kb4").cameras["right-2"]
    with pytest.raises(InputError, match="one kind of lens"):
        FORMATS["opencv"].write(Rig(cameras={"left": one, "right": other}), ".yml")
    larger = one.model_copy(update={"size": (620, 470)})
    with pytest.raises(InputError, match="one size of the pictures"):
        FORMATS["opencv"].write(Rig(cameras={"left": one, "right": larger}), ".yml")


@pytest.mark.parametrize("name", list(MOST))
def test_three_cameras_are_refused_where_two_are_the_most(name: str, make_rig: MakeRig) -> None:
    with pytest.raises(InputError, match="`only='left,right-2'`"):
        FORMATS[name].write(make_rig("pinhole", count=3), FORMATS[name].suffixes[0])


@pytest.mark.parametrize(("lens", "counts"), [("rational8", {5, 8}), ("thin-prism12", {5, 8, 12})])
def test_a_lost_coefficient_of_a_rig_is_an_error(
    lens: str, counts: set[int], make_rig: MakeRig, tmp_path: Path
) -> None:
    """Without one of its eight numbers the others would have stood for their neighbours."""
    content = json.loads(make_rig(lens).model_dump_json())
    whole = content["cameras"]["left"]["dist"]
    for count in range(5, len(whole) + 1):
        content["cameras"]["left"]["dist"] = whole[:count]
        path = tmp_path / f"{count}.json"
        path.write_text(json.dumps(content))
        if count in counts:
            read_rig_files([path], "labcal")
        else:
            with pytest.raises(InputError, match=rf"dist holds {count} coefficients, but should hold"):
                read_rig_files([path], "labcal")


@pytest.mark.parametrize("name", list(FORMATS))
def test_height_and_width_in_place_of_width_and_height_are_told(
    name: str, tmp_path: Path, make_rig: MakeRig
) -> None:
    """As of a size that was taken from the shape of an array; no format states which of both stands first."""
    chosen, rig = FORMATS[name], make_rig("pinhole", count=1 if name == "ros" else 2)
    exchanged = {key: one.model_copy(update={"size": (480, 640)}) for key, one in rig.cameras.items()}
    path = tmp_path / ("model" if chosen.home is Home.FOLDER else f"rig{chosen.suffixes[0]}")
    texts = chosen.write(Rig(cameras=exchanged), chosen.suffixes[0])
    files = write_rig_files(path, chosen, texts, force=False)
    paths = [path] if chosen.home is Home.FOLDER else files
    wrong, right = ConvertSettings(name, size="480x640"), ConvertSettings(name, size="640x480")
    stated = ConvertSettings(name) if name != "matchid" else wrong
    notes = [note for note in understood_cameras(paths, stated).notes if "seem to be exchanged" in note]
    assert len(notes) == len(rig.cameras)
    assert "480 x 640 px, seem to be exchanged" in notes[0]
    assert "off that of one of 640 x 480 px" in notes[0]
    if "size" not in chosen.options:
        assert notes[0].endswith("If so, exchange them in the file.")
        return
    assert notes[0].endswith("If so, give their size: `size='640x480'`.")
    mended = understood_cameras(paths, right)
    assert {camera.size for camera in mended.cameras.values()} == {(640, 480)}
    assert not any("exchanged" in note for note in mended.notes)


@pytest.mark.parametrize(
    ("size", "point", "words"),
    [
        ((720, 1280), (358.0, 650.0), None),  # a camera on its side
        ((720, 1280), (640.25, 355.75), "399 px off the middle of such a picture, and 3.82 px off"),
        ((1280, 720), (355.75, 640.25), "720 x 1280 px"),
        ((720, 1280), (480.0, 560.0), None),  # far off, but of neither size
        ((1000, 1050), (524.5, 499.5), None),  # nearly square: as far off as lenses are
        ((1280, 1024), (505.0, 650.0), "1024 x 1280 px"),
    ],
)
def test_a_camera_on_its_side_is_not_taken_for_one_with_exchanged_sides(
    size: tuple[int, int], point: tuple[float, float], words: str | None
) -> None:
    K = np.array([[900.0, 0.0, point[0]], [0.0, 905.0, point[1]], [0.0, 0.0, 1.0]])
    note = exchanged_sides_note("left", Camera(K, "pinhole", np.zeros(5), np.eye(4), size), "")
    assert note is None if words is None else note is not None and words in note
