"""The command inspect on a drawn shoot with one picture of each misfortune."""

import json
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.cli import console, main
from labcal.cli.status import ExitStatus
from labcal.shoot.dataset import write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.shoot.pictures import read_picture, write_picture
from labcal.targets.catalogue import load_target

TARGET = load_target("paper-13x10")
SIZE = (640, 480)


def drawn_target() -> np.ndarray:
    """Return the target seen from its front, its dots within the left two thirds of the picture."""
    zoom, scale = 8, 0.5
    canvas = np.full((SIZE[1] * zoom, SIZE[0] * zoom), 220, np.uint8)
    for index, (x, y, _) in zip(TARGET.indices().tolist(), TARGET.points(), strict=True):
        centre = (round((40 + scale * x) * zoom), round((420 - scale * y) * zoom))
        ring = tuple(index) in TARGET.ring_indices
        diameter = TARGET.ring_outer_diameter_mm if ring else TARGET.dot_diameter_mm
        cv2.circle(canvas, centre, round(diameter * scale * zoom / 2), 20, cv2.FILLED)
        if ring:
            cv2.circle(
                canvas, centre, round(TARGET.ring_inner_diameter_mm * scale * zoom / 2), 220, cv2.FILLED
            )
    noise = np.random.default_rng(0).normal(0, 1, SIZE[::-1])
    return np.clip(cv2.resize(canvas, SIZE, interpolation=cv2.INTER_AREA) + noise, 0, 255).astype(np.uint8)


@pytest.fixture
def shoot(tmp_path: Path) -> Path:
    folder = tmp_path / "shoot"
    (folder / "images").mkdir(parents=True)
    good = drawn_target()
    burnt = np.full(SIZE[::-1], 255, np.uint8)
    for name, picture in (("a_left", good), ("a_right", good), ("b_left", burnt)):
        write_picture(folder / "images" / f"{name}.png", picture)
    (folder / "images" / "b_right.png").write_bytes(b"no picture")
    views = tuple(
        ViewEntry(
            name=name,
            images={camera: f"images/{name}_{camera}.png" for camera in ("left", "right")},
            role=role,
            T_world_target_nominal=None,
        )
        for name, role in (("a", Role.TRAIN), ("b", Role.TEST))
    )
    cameras = {name: CameraEntry(size=SIZE) for name in ("left", "right")}
    write_manifest(folder, Manifest(target=TARGET, cameras=cameras, views=views))
    return folder


def test_every_picture_is_on_the_sheet_and_in_the_document(
    shoot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    sheet = tmp_path / "sheet.png"
    words = ["inspect", str(shoot), "-o", str(sheet), "--workers", "1", "--json"]
    assert main(words) == ExitStatus.PARTIAL
    document = json.loads(capsys.readouterr().out)
    good, _, burnt, broken = document["pictures"]
    assert (good["view"], good["camera"], good["role"], good["dots"]) == ("a", "left", "train", 130)
    assert good["reason"] is None
    assert good["median_level"] == pytest.approx(220 / 255, abs=0.01)
    assert 0.5 < good["sharpness"] < 0.71  # drawn without any blur
    assert (burnt["saturated_share"], burnt["sharpness"], burnt["dots"]) == (1.0, None, 0)
    assert "no-dots" in burnt["reason"]
    assert (broken["role"], broken["median_level"]) == ("test", None)
    assert "b_right.png" in broken["reason"]
    # Dots from x = 40 to 390 and y = 70 to 420 lie in columns 0 to 4 and rows 0 to 5.
    assert document["cameras"]["left"] == {"coverage": 30 / 48, "dots": 130}
    picture = read_picture(sheet)
    assert picture.shape[1] < 4000
    assert (picture == (190, 40, 32)).all(axis=-1).any()

    assert main(words) == ExitStatus.UNUSABLE
    assert "--force" in capsys.readouterr().err


def test_a_folder_that_is_no_shoot(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["inspect", str(tmp_path), "-o", str(tmp_path / "sheet.png")]) == ExitStatus.UNUSABLE
    assert "There are no pictures" in capsys.readouterr().err
    assert not (tmp_path / "sheet.png").exists()


def test_loose_pictures_are_inspected_when_their_target_is_named(
    shoot: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    images = [str(shoot / "images" / f"a_{camera}.png") for camera in ("left", "right")]
    words = ["inspect", *images, "-o", str(tmp_path / "sheet.png"), "--workers", "1", "--json"]
    assert main(words) == ExitStatus.UNUSABLE
    assert "--cameras '_left=left,_right=right'" in capsys.readouterr().err
    words += ["--cameras", "_left=l,_right=r"]
    assert main(words) == ExitStatus.UNUSABLE
    assert "--target NAME" in capsys.readouterr().err
    assert main([*words, "--target", TARGET.name]) == ExitStatus.DONE
    document = json.loads(capsys.readouterr().out)
    assert [(one["camera"], one["role"], one["dots"]) for one in document["pictures"]] == [
        ("l", None, 130),
        ("r", None, 130),
    ]
    assert document["cameras"]["r"] == {"coverage": 30 / 48, "dots": 130}


def test_pictures_without_a_dot_have_a_sheet_and_ones_that_cannot_be_read_a_reason(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    write_picture(tmp_path / "bare.png", np.full((48, 64), 200, np.uint8))
    (tmp_path / "text.png").write_text("no picture")
    sheet = tmp_path / "sheet.png"
    words = ["--target", "paper-13x10", "--workers", "1", "-o", str(sheet), "--json"]
    assert main(["inspect", str(tmp_path / "bare.png"), *words]) == ExitStatus.PARTIAL
    assert json.loads(capsys.readouterr().out)["cameras"] == {"camera": {"coverage": 0.0, "dots": 0}}
    sheet.unlink()
    assert main(["inspect", str(tmp_path / "text.png"), *words]) == ExitStatus.UNUSABLE
    assert "The only picture cannot be used" in json.loads(capsys.readouterr().out)["error"]["message"]
    assert not sheet.exists()


def test_names_are_whole_at_80_columns_and_a_reason_is_told_once(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(console, "_WIDTH_OF_A_FILE", 80)
    names = [f"a-rather-long-name-of-a-view-that-only-ends-in-another-number-{n}" for n in range(4)]
    for name in names:
        write_picture(tmp_path / f"{name}.png", np.full((48, 64), 200, np.uint8))
    words = [str(tmp_path), "--target", "paper-13x10", "--workers", "1", "--cameras", "*=camera"]
    for verb in ("inspect", "detect"):
        main([verb, *words, "-o", str(tmp_path / f"{verb}.png")])
        out = capsys.readouterr().out
        cells = "".join(
            line.split("\u2502")[1].strip() for line in out.splitlines() if line.count("\u2502") > 2
        )
        assert all(name in cells for name in names)
        assert " ".join(out.split()).count("No dots were found") == 1
        assert "4 pictures" in out
