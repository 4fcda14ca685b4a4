"""What the commands refuse: the status, a message that helps, and nothing half-written left behind."""

import errno
import json
import os
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, NoReturn

import pytest

from labcal.correspond.detections_csv import read_detections
from labcal.run.begun import COMMAND

Run = Callable[..., Any]

SMALL = ("--spp", 1, "--workers", 1, "--set", "photometry.bayer=off", "--views", 1)


def refused(labcal: Run, said: str, *words: object, status: int = 2) -> None:
    """Assert the status and that the message, on stderr and in the document, holds `said`."""
    told = labcal(*words)
    assert told.status == status, told
    assert said in told.document["error"]["message"]
    assert told.document["error"]["message"] in told.said
    assert told.document["error"]["status"] == status


@pytest.fixture
def empty(tmp_path: Path) -> Path:
    """A folder in which nothing may be left."""
    (tmp_path / "empty").mkdir()
    return tmp_path / "empty"


@pytest.fixture
def model(labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path) -> Path:
    words = ("--method", "affine", "--detections", stage_dots, "-o", tmp_path / "model")
    assert labcal("fit", stage, *words).status == 0
    return tmp_path / "model"


@pytest.fixture
def copy(stage: Path, tmp_path: Path) -> Path:
    """A shoot that a test may damage."""
    shutil.copytree(stage, tmp_path / "copy")
    return tmp_path / "copy"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["rendr"], "'render'"),
        (["render", "webcam-plain", "-o", "x"], "Did you mean 'webcam-plane'?"),
        (["render", "webcam-plane", "-o", "x", "--veiws", "3"], "'--views'"),
        (["render", "webcam-plane", "-o", "x", "--views", "0"], "at least 1"),
        (["render", "webcam-plane", "-o", "x", "--spp", "70000"], "spp"),
        (["render", "webcam-plane", "-o", "x", "--set", "photometry.blur_pix=1"], "'photometry.blur_px'?"),
        (["render", "webcam-plane", "-o", "x", "--set", "nose=off"], "Did you mean 'noise'?"),
        (["render", "webcam-plane", "-o", "x", "--set", "noise"], "key=value"),
        (
            ["render", "webcam-plane", "-o", "x", "--set", "photometry.read_noise_e=-1"],
            "should be at least 0",
        ),
        (["render", "webcam-plane", "-o", "x", "--set", "target=paper-13x11"], "Did you mean 'paper-13x10'?"),
        (
            ["render", "webcam-plane", "-o", "x", "--set", "cameras.left.lens=brown6"],
            "Did you mean 'brown5'?",
        ),
        (["scene", "show", "stil-plane"], "Did you mean 'still-plane'?"),
        (["detect", ".", "--target", "ring-10x8", "-o", "x"], "There are no pictures"),
        (["detect", ".", "--tone-curve", "sgrb", "-o", "x"], "Did you mean 'srgb'?"),
        (["calibrate", "x.csv", "--lens", "brown-k1-k2", "-o", "x"], "Did you mean 'brown-k1k2'?"),
        (["calibrate", "x.csv", "--target", "rings-10x9", "-o", "x"], "Did you mean 'rings-10x8'?"),
        (["fit", "x", "--method", "afine", "-o", "x"], "Did you mean 'affine'?"),
        (["fit", "x", "--method", "affine,affine", "-o", "x"], "names a method twice"),
        (["fit", "nowhere", "--method", "affine", "-o", "x"], "nowhere does not exist"),
        (["detect", "nowhere", "--target", "rings-10x8", "-o", "x"], "no picture or folder nowhere"),
        (["reconstruct", "nowhere", "x", "-o", "x"], "The model nowhere cannot be read"),
        (["evaluate", "nowhere.csv", "x"], "The points nowhere.csv cannot be read"),
    ],
    ids=lambda value: " ".join(value[:1] + value[-1:]) if isinstance(value, list) else "",
)
def test_misspelled_and_impossible_words(
    labcal: Run, words: list[str], said: str, empty: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(empty)
    refused(labcal, said, *words)
    assert list(empty.iterdir()) == []


def test_an_unknown_key_in_a_scene_offers_the_nearest(labcal: Run, tmp_path: Path) -> None:
    shown = labcal("scene", "show", "webcam-plane").document
    shown["cameras"]["left"]["focal_pix"] = shown["cameras"]["left"].pop("focal_px")
    shown["placement"]["views"][1]["orign_mm"] = shown["placement"]["views"][1].pop("origin_mm")
    shown["placement"]["kind_"] = 1
    path = tmp_path / "lab.yaml"
    path.write_text(json.dumps(shown))  # JSON is YAML
    for said in ("focal_pix: this key is not known; the nearest one is 'focal_px'", "'origin_mm'", "'kind'"):
        refused(labcal, said, "render", path, "-o", tmp_path / "x")
    assert not list(tmp_path.glob("x*"))


def test_damaged_pictures_are_told_and_the_others_measured(
    labcal: Run, copy: Path, stage_dots: Path, tmp_path: Path
) -> None:
    jpeg = copy / "images" / "train_left.jpg"
    jpeg.write_bytes(jpeg.read_bytes()[:-2000])
    small = copy / "images" / "train_right.jpg"
    shutil.copy(next(copy.glob("images/test-shifted_left.jpg")), small)
    (copy / "images" / "test-shifted_right.jpg").unlink()
    told = labcal("detect", copy, "-o", tmp_path / "dots.csv", "--workers", 1)
    assert told.status == 1
    assert (told.document["indexed"], told.document["refused"]) == (2, 2)
    by_name = {Path(image["image"]).name: image for image in told.document["images"]}
    assert by_name["train_left.jpg"]["status"] == "refused"
    assert "truncated" in by_name["train_left.jpg"]["reason"]
    assert "No such file" in by_name["test-shifted_right.jpg"]["reason"]
    assert by_name["test-shifted_left.jpg"]["dots"] == 130
    table, whole = read_detections(tmp_path / "dots.csv"), read_detections(stage_dots)
    kept = whole.where((whole.view == "test-shifted") & (whole.camera == "left"))
    found = table.where((table.view == "test-shifted") & (table.camera == "left"))
    assert found.position.tobytes() == kept.position.tobytes()


def test_a_picture_of_another_size_is_told(labcal: Run, copy: Path, tmp_path: Path) -> None:
    manifest = json.loads((copy / "shoot.json").read_text())
    manifest["cameras"]["left"]["size"] = [320, 240]
    manifest["views"] = manifest["views"][:1]
    (copy / "shoot.json").write_text(json.dumps(manifest))
    told = labcal("detect", copy, "-o", tmp_path / "dots.csv", "--workers", 1)
    assert told.status == 1
    assert "is 640 x 480, but the shoot states that camera 'left' takes 320 x 240" in str(told.document)


def test_nothing_usable_is_status_2(labcal: Run, copy: Path, empty: Path) -> None:
    for path in (copy / "images").iterdir():
        path.write_bytes(path.read_bytes()[:1000])
    told = labcal("detect", copy, "-o", empty / "d", "--workers", 1)
    assert told.status == 2
    assert (told.document["indexed"], told.document["refused"]) == (0, 4)
    assert all("truncated" in image["reason"] for image in told.document["images"])
    shutil.rmtree(copy / "images")
    refused(labcal, "None of the 4 pictures", "calibrate", copy, "-o", empty / "r", "--workers", 1)
    manifest = json.loads((copy / "shoot.json").read_text())
    (copy / "shoot.json").write_text(json.dumps(manifest | {"views": []}))
    for verb, rest in (("detect", []), ("fit", ["--method", "affine"]), ("calibrate", [])):
        refused(labcal, "has no pictures", verb, copy, *rest, "-o", empty / "x")
    assert list(empty.iterdir()) == []


def test_a_folder_that_is_no_shoot(
    labcal: Run, model: Path, empty: Path, tmp_path: Path, stage_dots: Path
) -> None:
    (tmp_path / "else").mkdir()
    for words in (
        ("fit", tmp_path / "else", "--method", "affine"),
        ("reconstruct", model, tmp_path / "else"),
        ("calibrate", tmp_path / "else", "--target", "paper-13x10"),
    ):
        refused(labcal, "else is not a shoot", *words, "-o", empty / "x")
    points = tmp_path / "points.csv"
    assert labcal("reconstruct", model, stage_dots, "-o", points).status == 0
    refused(labcal, "else is not a shoot", "evaluate", points, tmp_path / "else")
    refused(labcal, "Name the target: --target", "calibrate", stage_dots, "-o", empty / "x")
    assert list(empty.iterdir()) == []


@pytest.fixture
def writing(stage: Path, stage_dots: Path, model: Path) -> list[tuple[object, ...]]:
    """Return a command of every kind that writes, without its -o."""
    return [
        ("render", "webcam-plane", *SMALL),
        ("detect", stage / "images" / "train_left.jpg", "--target", "paper-13x10", "--workers", 1),
        ("fit", stage, "--method", "affine", "--detections", stage_dots),
        ("reconstruct", model, stage_dots),
    ]


def test_folders_that_cannot_be_written(
    labcal: Run, writing: list[tuple[object, ...]], tmp_path: Path
) -> None:
    (tmp_path / "file").write_text("mine")
    for words in writing:
        refused(labcal, "cannot be written: Not a directory", *words, "-o", tmp_path / "file" / "x")
    for words in writing[1:]:
        refused(labcal, "cannot be written: there is no folder", *words, "-o", tmp_path / "none" / "x")
    assert (tmp_path / "file").read_text() == "mine"


def test_what_exists_stays(labcal: Run, writing: list[tuple[object, ...]], tmp_path: Path) -> None:
    mine = tmp_path / "mine"
    mine.write_text("mine")
    for words in writing:
        refused(labcal, "mine exists already", *words, "-o", mine)
    detect = writing[1]
    refused(labcal, "mine exists already", *detect, "-o", tmp_path / "dots.csv", "--overlay", mine)
    assert mine.read_text() == "mine"
    assert not (tmp_path / "dots.csv").exists()
    refused(labcal, "mine is not replaced: it is not a table of points", *writing[3], "-o", mine, "--force")
    assert mine.read_text() == "mine"
    mine.write_text("")
    assert labcal(*writing[3], "-o", mine, "--force").status == 0
    assert mine.read_text().startswith("view,col,row")


@pytest.mark.parametrize("number", [errno.ENOSPC, errno.EACCES], ids=["full", "forbidden"])
def test_a_disk_that_refuses_leaves_nothing(
    labcal: Run,
    writing: list[tuple[object, ...]],
    empty: Path,
    monkeypatch: pytest.MonkeyPatch,
    number: int,
) -> None:
    full = number == errno.ENOSPC
    said, status = ("The disk is full", 3) if full else ("cannot be written: Permission denied", 2)

    def refuse(path: Path, data: bytes) -> NoReturn:  # noqa: ARG001 - a path's form
        raise OSError(number, os.strerror(number), str(path))

    monkeypatch.setattr(Path, "write_bytes", refuse)  # a file that exists but takes no content
    for words in writing[1:]:
        refused(labcal, said, *words, "-o", empty / "x", status=status)
        assert list(empty.iterdir()) == []
    # A shoot keeps its unfinished folder, to go on from, but no half-written picture in it.
    refused(labcal, said, *writing[0], "-o", empty / "x", status=status)
    assert [path.name for path in empty.iterdir()] == ["x.unfinished"]
    assert list((empty / "x.unfinished" / "images").iterdir()) == []
    monkeypatch.undo()
    assert labcal(*writing[0], "-o", empty / "x").status == 0
    assert [path.name for path in empty.iterdir()] == ["x"]


def test_an_unfinished_shoot_of_another_command_stays(labcal: Run, empty: Path) -> None:
    unfinished = empty / "x.unfinished"
    unfinished.mkdir()
    (unfinished / COMMAND).write_text("another")
    refused(
        labcal, "unfinished output of another command", "render", "webcam-plane", *SMALL, "-o", empty / "x"
    )
    assert [path.name for path in unfinished.iterdir()] == [COMMAND]
    assert labcal("render", "webcam-plane", *SMALL, "-o", empty / "x", "--force").status == 0


def test_damaged_tables_name_the_line(
    labcal: Run, stage: Path, stage_dots: Path, model: Path, tmp_path: Path, empty: Path
) -> None:
    lines = stage_dots.read_text().splitlines(keepends=True)
    damaged = tmp_path / "damaged.csv"
    damaged.write_text("".join([*lines[:40], lines[40][:30] + "\n", *lines[41:]]))
    for words in (
        ("reconstruct", model, damaged),
        ("fit", stage, "--method", "affine", "--detections", damaged),
        ("calibrate", damaged, "--target", "paper-13x10"),
    ):
        refused(labcal, f"Line 41 of {damaged} is damaged", *words, "-o", empty / "x")
    points = tmp_path / "points.csv"
    assert labcal("reconstruct", model, stage_dots, "-o", points).status == 0
    whole = points.read_text()
    points.write_text(whole[:-40])
    refused(labcal, f"Line 261 of {points} is damaged", "evaluate", points, stage)
    points.write_text(whole)
    refused(labcal, f"Line 41 of {damaged} is damaged", "evaluate", points, stage, "--detections", damaged)
    assert list(empty.iterdir()) == []


def test_dots_that_do_not_belong_to_the_model(
    labcal: Run, stage_dots: Path, model: Path, tmp_path: Path, empty: Path
) -> None:
    text = stage_dots.read_text()
    other, alone = tmp_path / "other.csv", tmp_path / "alone.csv"
    other.write_text(text.replace(",640,480,", ",1280,960,"))
    alone.write_text("".join(line for line in text.splitlines(keepends=True) if ",right," not in line))
    said = "was calibrated with pictures of 640 x 480, but these are 1280 x 960"
    refused(labcal, said, "reconstruct", model, other, "-o", empty / "x")
    refused(labcal, "no detections of camera right", "reconstruct", model, alone, "-o", empty / "x")
    damaged = tmp_path / "damaged"
    damaged.write_bytes(model.read_bytes()[:-10])
    refused(labcal, "truncated", "reconstruct", damaged, stage_dots, "-o", empty / "x")
    assert list(empty.iterdir()) == []


def test_another_target_is_refused(labcal: Run, stage_dots: Path, empty: Path) -> None:
    words = ("calibrate", stage_dots, "--target", "rings-10x8", "-o", empty / "x")
    refused(labcal, "the target 'rings-10x8' has 10 x 8 dots. Name the target", *words)
    assert list(empty.iterdir()) == []
