"""Prints as files: rasterised at 600 dpi and photographed, they tell their target without its name."""

import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest
from photographs import photograph

from labcal.correspond.detections_csv import read_detections
from labcal.targets.catalogue import load_target, target_names
from tests.system.conftest import Run
from tests.system.printed_scene import ONE_OF_A_KIND

DPI = 600


def rasterised(labcal: Run, name: str, folder: Path, dpi: int = DPI) -> Path:
    """Return the picture of a PDF, as poppler draws it."""
    if shutil.which("pdftoppm") is None:
        pytest.skip("pdftoppm (Debian: poppler-utils) is not installed")
    told = labcal("target", "export", name, "-o", folder / "print.pdf")
    assert told.status == 0
    assert told.document["code"].startswith("LABCAL1:")
    command = [
        "pdftoppm",
        "-r",
        str(dpi),
        "-gray",
        "-png",
        "-singlefile",
        folder / "print.pdf",
        folder / "print",
    ]
    subprocess.run([str(word) for word in command], check=True)
    return folder / "print.png"


@pytest.mark.slow
@pytest.mark.parametrize("name", ONE_OF_A_KIND)
def test_a_raster_of_the_pdf_has_the_pitch_and_tells_the_target(
    labcal: Run, name: str, tmp_path: Path
) -> None:
    page = rasterised(labcal, name, tmp_path)
    told = labcal("detect", page, "-o", tmp_path / "d.csv", "--workers", 1)
    assert told.status == 0
    assert (told.document["target"], told.document["target_read_from"]) == (name, str(page))
    target, dots = load_target(name), read_detections(tmp_path / "d.csv")
    ok = dots.flag == "ok"
    assert dots.has_id.sum() >= target.count
    assert ok.sum() == target.count
    mm = dots.position[ok] * [25.4 / DPI, -25.4 / DPI]
    places = target.points(dots.index[ok])[:, :2]
    turns = [places, -places] if target.symmetric_indices(target.indices()) else [places]
    off = [np.abs((mm - mm.mean(axis=0)) - (turn - turn.mean(axis=0))).max() for turn in turns]
    assert min(off) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "size"),
    [(one, (1280, 960)) for one in target_names() if one not in ONE_OF_A_KIND]
    + [("paper-13x10", (2592, 1944))],
)
def test_photographs_at_45_degrees_tell_the_target(
    labcal: Run, name: str, size: tuple[int, int], tmp_path: Path
) -> None:
    page = cv2.imread(str(rasterised(labcal, name, tmp_path, 100 if name == "paper-13x10" else 300)), 0)
    assert page is not None
    wide = load_target(name)
    fill = min(0.85, 0.85 * size[1] / size[0] * page.shape[1] / page.shape[0])
    assert wide.count > 0
    for number, axis in enumerate((0.0, 90.0, 40.0)):
        cv2.imwrite(str(tmp_path / f"v{number}.png"), photograph(page, size, fill, 45.0, axis))
    pictures = [tmp_path / f"v{number}.png" for number in range(3)]
    told = labcal("detect", *pictures, "-o", tmp_path / "d.csv", "--workers", 1)
    assert told.status == 0
    assert told.document["target"] == name
    found = [image["dots"] for image in told.document["images"]]
    assert found == [wide.count] * 3


def test_a_shoot_is_captured_and_calibrated_without_naming_the_target(labcal: Run, tmp_path: Path) -> None:
    (tmp_path / "print").mkdir()
    page = cv2.imread(str(rasterised(labcal, "rings-14x10", tmp_path / "print", 203)), 0)
    assert page is not None
    (tmp_path / "in").mkdir()
    for number, (tilt, axis) in enumerate([(5.0, 0.0), (35.0, 0.0), (35.0, 90.0), (30.0, 45.0)]):
        picture = photograph(page, (900, 700), 0.8, tilt, axis)
        cv2.imwrite(str(tmp_path / "in" / f"v{number}.png"), picture)
    shoot = tmp_path / "shoot"
    told = labcal("capture", f"folder:{tmp_path / 'in'}", "-o", shoot, "--print-scale", "99.8/100")
    assert told.status == 0
    assert "is read from the code" in told.said
    assert '"print_scale": [\n      0.998' in (shoot / "shoot.json").read_text()
    assert '"print_number": 0' in (shoot / "shoot.json").read_text()
    again = labcal("detect", shoot, "-o", tmp_path / "d.csv", "--workers", 1, "--print-scale", "99.8/100")
    assert again.status == 2
    assert "stated already" in again.said + str(again.document)
    plain = labcal("detect", *sorted((tmp_path / "in").iterdir()), "-o", tmp_path / "d.csv", "--workers", 1)
    assert plain.document["target"] == "rings-14x10"
    rig = labcal("calibrate", tmp_path / "d.csv", "-o", tmp_path / "rig.json", "--lens", "pinhole")
    assert rig.status in (0, 1)
    assert "is read from the code" in rig.said


def test_pictures_without_a_code_ask_for_the_name(labcal: Run, tmp_path: Path) -> None:
    cv2.imwrite(str(tmp_path / "a.png"), np.full((200, 300), 128, np.uint8))
    told = labcal("detect", tmp_path / "a.png", "-o", tmp_path / "d.csv", "--workers", 1)
    assert told.status == 2
    assert "--target NAME" in str(told.document)
