"""A path is a text or anything that stands for one, wherever a file is named."""

from collections.abc import Callable
from os import PathLike
from pathlib import Path

import numpy as np
import pytest

from labcal import examples, load_target
from labcal.cameras.interop.conversion import ConvertSettings, convert_cameras
from labcal.cameras.interop.registry import format_by_name, format_to_write
from labcal.cameras.interop.rig_files import read_rig_files, rig_outputs, write_rig_files
from labcal.cameras.rig import Rig
from labcal.correspond.interop.conversion import convert_detections
from labcal.errors import InputError
from labcal.paths import as_path, as_text
from labcal.report.reproduction import read_reproduction
from labcal.run.documents import read_document
from labcal.scene.catalogue import load_scene
from labcal.shoot.exr import read_exr, read_exr_texts, write_exr
from labcal.shoot.pictures import (
    picture_output,
    png_output,
    read_picture,
    write_picture,
    write_single_picture,
)
from labcal.shoot.truth import has_truth, read_true_dots, read_truth
from labcal.targets.artwork import artwork_output, export_artwork

Given = Callable[[Path], str | PathLike[str]]


class Entry:
    """What stands for a path without being a :class:`pathlib.Path`."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def __fspath__(self) -> str:
        return str(self.path)


@pytest.fixture(params=[str, Path, Entry])
def given(request: pytest.FixtureRequest) -> Given:
    return request.param  # type: ignore[no-any-return]


def test_pictures_are_written_and_read(given: Given, tmp_path: Path) -> None:
    picture = np.arange(48, dtype=np.uint8).reshape(6, 8)
    write_picture(given(tmp_path / "a.png"), picture)
    write_single_picture(given(tmp_path / "b.png"), picture)
    for name in ("a.png", "b.png"):
        np.testing.assert_array_equal(read_picture(given(tmp_path / name)), picture)
    assert png_output(given(tmp_path / "a.png")).path == tmp_path / "a.png"
    assert picture_output(given(tmp_path / "a.tif")).path == tmp_path / "a.tif"
    light = picture.astype(np.float32)
    write_exr(given(tmp_path / "a.exr"), light, {"unit": "none"})
    np.testing.assert_array_equal(read_exr(given(tmp_path / "a.exr")), light)
    assert read_exr_texts(given(tmp_path / "a.exr"))["unit"] == "none"
    np.testing.assert_array_equal(read_picture(given(tmp_path / "a.exr")), light)


def test_targets_and_scenes_are_named_or_lie_somewhere(given: Given, tmp_path: Path) -> None:
    path = tmp_path / "board.svg"
    target = load_target(given(Path(examples.TARGET)))
    assert target == load_target(examples.TARGET)
    export_artwork(target, given(path))
    assert path.read_bytes()
    assert artwork_output(given(path)).path == path
    assert load_scene(given(Path("webcam-plane"))) == load_scene("webcam-plane")
    with pytest.raises(InputError, match="nowhere"):
        load_scene(given(tmp_path / "nowhere.yaml"))
    with pytest.raises(InputError, match="nowhere"):
        load_target(given(tmp_path / "nowhere.yaml"))


def test_cameras_of_other_systems_are_written_and_read(given: Given, tmp_path: Path) -> None:
    rig, path = examples.rig(), given(tmp_path / "stereo.yml")
    opencv = format_by_name("opencv")
    texts = opencv.write(rig, ".yml")
    assert rig_outputs(path, opencv, texts)
    write_rig_files(path, opencv, texts, force=False)
    _, read = read_rig_files([path], "opencv")
    assert list(read.rig.cameras) == ["left", "right"]
    assert format_to_write(given(tmp_path / "stereo.cameramodel")).name == "mrcal"


def test_folders_are_found_without_what_is_looked_for_in_them(given: Given, tmp_path: Path) -> None:
    assert not has_truth(given(tmp_path))
    for read in (read_truth, read_true_dots, read_reproduction):
        with pytest.raises(InputError, match=tmp_path.name):
            read(given(tmp_path))  # type: ignore[operator]


def test_a_path_that_says_that_it_is_one_is_not_taken_for_a_name() -> None:
    assert as_text("./rings-10x8") == "./rings-10x8"
    with pytest.raises(InputError):
        load_target("./rings-10x8")


def test_documents_and_conversions_take_any_path(given: Given, tmp_path: Path) -> None:
    examples.rig().save(given(tmp_path / "rig.json"))
    assert read_document(Rig, "rig", given(tmp_path / "rig.json")) == examples.rig()
    settings = ConvertSettings(to_format="opencv")
    made = convert_cameras(
        [given(tmp_path / "rig.json")], given(tmp_path / "a.yml"), settings, [], force=False
    )
    assert made.files == [str(tmp_path / "a.yml")]
    examples.detections().save(given(tmp_path / "dots.csv"))
    target = ConvertSettings(target=given(Path(examples.TARGET)))
    made = convert_detections(
        [given(tmp_path / "dots.csv")], given(tmp_path / "a.vnl"), target, [], force=False
    )
    assert made.files == [str(tmp_path / "a.vnl")]


@pytest.mark.parametrize("path", ["", "a\0b", "x" * 300, Path("x" * 300), Path("folder") / ("x" * 256)])
def test_a_path_that_no_file_can_have_is_refused(path: str | Path) -> None:
    with pytest.raises(InputError, match="path"):
        as_path(path)
    assert as_path("x" * 255).name == "x" * 255
