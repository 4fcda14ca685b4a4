"""``labcal check`` as a command: the same as the function, exit statuses, wrong use."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal import NamedPixels, check, examples, pipeline, read_detections, read_rig, write_detections
from labcal.cameras.rig import Rig
from labcal.geometry.poses import from_rotation_vector
from labcal.guide.check_settings import CheckSettings
from labcal.report.check_result import check_result
from labcal.run.json_text import plain_data

Run = Callable[..., Any]


@pytest.fixture(scope="module")
def home(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return a folder with a rig, a rig whose right camera was turned, and dots."""
    folder = tmp_path_factory.mktemp("check")
    rig = pipeline.calibrate(examples.TARGET, examples.detections()).rig
    rig.save(folder / "rig.json")
    left, right = (rig.camera(name) for name in ("left", "right"))
    turn = from_rotation_vector(np.array([0.002, 0.001, 0.0]), np.zeros(3))
    turned = Rig.of({"left": left, "right": replace(right, T_cam_world=turn @ right.T_cam_world)})
    known = {"covariance": rig.covariance, "calibration": rig.calibration}
    turned.model_copy(update=known).save(folder / "turned.json")
    write_detections(folder / "dots.csv", examples.detections())
    return folder


def test_the_function_and_the_command_make_the_same(labcal: Run, home: Path) -> None:
    words = ("check", home / "turned.json", home / "dots.csv", "--target", examples.TARGET)
    log = ("--log", home / "command.jsonl", "--date", "2026-05-04", "--note", "turned")
    told = labcal(*words, *log, "--mend", home / "mended.json")
    settings = CheckSettings(home / "python.jsonl", "2026-05-04", note="turned")
    found = check(home / "turned.json", read_detections(home / "dots.csv"), examples.TARGET, settings)
    assert told.status == 1
    document = plain_data(check_result(found, home / "mended.json"))
    assert told.document == document
    assert (home / "command.jsonl").read_bytes() == (home / "python.jsonl").read_bytes()
    assert read_rig(home / "mended.json") == found.mended()
    again = labcal("check", home / "mended.json", home / "dots.csv", "--target", examples.TARGET)
    assert (again.status, again.document["verdict"]) == (0, "valid")


def test_fixed_marks_by_the_function_and_by_the_command(labcal: Run, home: Path) -> None:
    rig, pixels = read_rig(home / "rig.json"), examples.pixels()
    pipeline.measure(rig, pixels).save(home / "places.csv")
    moved = np.where(
        (pixels.camera == "right")[:, None], pixels.position + np.array([8.0, 0.0]), pixels.position
    )
    NamedPixels(pixels.view, pixels.camera, pixels.point, moved, pixels.covariance).save(home / "pixels.csv")
    settings = CheckSettings(places=home / "places.csv")
    told = labcal("check", home / "rig.json", home / "pixels.csv", "--places", home / "places.csv")
    found = check(home / "rig.json", home / "pixels.csv", None, settings)
    assert told.status == 1
    assert told.document == plain_data(check_result(found))
    assert found.camera == "right"
    assert check(rig, NamedPixels.load(home / "pixels.csv"), None, settings).p_value == found.p_value


def test_the_target_of_the_calibration_is_taken_where_none_is_named(labcal: Run, home: Path) -> None:
    words = ("check", home / "rig.json", home / "dots.csv")
    kept, named = labcal(*words), labcal(*words, "--target", examples.TARGET)
    assert kept.document == named.document


def test_wrong_use(labcal: Run, home: Path) -> None:
    older = Rig.load(home / "rig.json").model_copy(update={"target": None})
    older.save(home / "older.json", force=True)
    for words, expected in [
        (("older.json", "dots.csv"), "--target"),
        (("rig.json", "dots.csv", "--target", examples.TARGET, "--note", "x"), "--log"),
        (("rig.json", "dots.csv", "--target", examples.TARGET, "--force"), "--force"),
        (("rig.json", "dots.csv", "--target", examples.TARGET, "--workers", "2"), "--workers"),
        (("rig.json", "dots.csv", "--target", examples.TARGET, "--places", "dots.csv"), "--target"),
        (("rig.json", "dots.csv", "--target", examples.TARGET, "--markers", "dots"), "places"),
        (("rig.json", "dots.csv", "--places", "dots.csv"), "--markers"),
        (("rig.json", "nothing.csv", "--target", examples.TARGET), "nothing.csv"),
    ]:
        told = labcal("check", *(home / word if "." in word else word for word in words))
        assert told.status == 2
        assert expected in told.document["error"]["message"]
