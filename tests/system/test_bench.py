"""``labcal bench detect`` from the command line, and what ``labcal detect`` makes of files that are none."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from labcal.bench.detect.speed import TARGET, drawn_board
from labcal.rng import generator
from labcal.shoot.pictures import write_picture

Run = Callable[..., Any]


def test_a_group_that_cannot_be_measured_says_so(
    labcal: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("LABCAL_REAL_DATA", str(tmp_path / "nowhere"))
    told = labcal("bench", "detect", "--only", "real", "-o", tmp_path / "out")
    assert told.status == 0
    assert told.document["checks"] == []
    assert "LABCAL_REAL_DATA" in told.document["notes"][0]
    assert (tmp_path / "out" / "results.json").is_file()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("detect", "--only", "sweet"), "no group of checks named 'sweet'"),
        (
            ("render", "--only", "suite"),
            "of which the benchmark 'render' has none",
        ),
    ],
)
def test_groups_that_are_not_there_are_refused(
    labcal: Run, tmp_path: Path, words: tuple[str, ...], said: str
) -> None:
    told = labcal("bench", *words, "-o", tmp_path / "out")
    assert told.status == 2
    assert said in told.document["error"]["message"]
    assert not any(tmp_path.iterdir())


def test_files_that_are_no_pictures_do_not_stop_the_others(labcal: Run, tmp_path: Path) -> None:
    shown = tmp_path / "target.yaml"
    shown.write_text(TARGET.model_dump_json())  # JSON is YAML
    home = tmp_path / "pictures"
    home.mkdir()
    write_picture(home / "a.png", drawn_board((640, 480), generator(0, "test")))
    (home / "b.png").mkdir()
    (home / "c.png").write_text("text")
    (home / "d.jpg").write_bytes(b"")
    (home / "e.exr").write_bytes(b"\x76\x2f\x31\x01" + bytes(100))
    told = labcal("detect", home, "--target", shown, "-o", tmp_path / "dots.csv", "--workers", 1)
    assert told.status == 1
    assert (told.document["indexed"], told.document["refused"]) == (1, 4)
    reasons = [one["reason"] for one in told.document["images"]]
    assert reasons[0] is None
    for reason, said in zip(
        reasons[1:], ("it is no file", "not a picture", "not a picture", "OpenEXR"), strict=True
    ):
        assert said in reason
