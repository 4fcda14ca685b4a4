"""The log of checks, its settings, and the page that draws it."""

from pathlib import Path

import pytest

from labcal import check, examples, pipeline
from labcal.errors import InputError, OutputError
from labcal.guide.check_log import CheckRecord, read_check_log, write_check_log
from labcal.guide.check_settings import CheckSettings
from labcal.guide.rig_check import CheckVerdict
from labcal.report.check_history import check_history


def record(**changes: object) -> CheckRecord:
    """Return a line of a log."""
    values: dict[str, object] = {
        "date": "2026-05-04T09:30:00", "rig": "rig.json", "verdict": CheckVerdict.CHANGED, "p_value": 1e-9,
        "camera": "left", "kind": "turned", "turn_deg": 0.1, "shift_mm": None, "focus_percent": None,
        "cost_rms_mm": 0.4, "budget_mm": 0.1, "views": 3, "sigma0": 1.0, "temperature_c": 21.5,
    }  # fmt: skip
    return CheckRecord.model_validate({**values, **changes})


def test_a_log_is_read_as_it_was_written(tmp_path: Path) -> None:
    lines = (record(), record(verdict="valid", camera=None, kind=None, turn_deg=None, cost_rms_mm=None))
    write_check_log(tmp_path / "log.jsonl", lines)
    assert read_check_log(tmp_path / "log.jsonl") == lines
    assert "svg" in check_history(lines)


def test_a_file_of_something_else_is_not_continued(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine\n")
    with pytest.raises(OutputError, match="not a log of checks"):
        write_check_log(tmp_path / "notes.txt", [record()])
    with pytest.raises(InputError, match="line 1"):
        read_check_log(tmp_path / "notes.txt")
    assert (tmp_path / "notes.txt").read_text() == "mine\n"


@pytest.mark.parametrize(
    ("settings", "words"),
    [
        ({"note": "x"}, "Give `log`"),
        ({"log": "l", "date": "yesterday"}, "2026-05-04"),
        ({"log": "l", "temperature_c": -300.0}, "degrees Celsius"),
        ({"log": "l", "note": "two\nlines"}, "a line of at most"),
    ],
)
def test_wrong_settings(settings: dict[str, object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        CheckSettings(**settings)  # type: ignore[arg-type]


def test_a_check_adds_a_line_and_makes_a_page(tmp_path: Path) -> None:
    rig = pipeline.calibrate(examples.TARGET, examples.detections()).rig
    rig.save(tmp_path / "rig.json")
    settings = CheckSettings(tmp_path / "log.jsonl", "2026-05-04", 20.0, "first")
    found = check(
        tmp_path / "rig.json", examples.detections(), examples.TARGET, settings, page=tmp_path / "page.html"
    )
    (line,) = read_check_log(tmp_path / "log.jsonl")
    assert (line.rig, line.verdict, line.p_value, line.note) == (
        "rig.json",
        found.verdict,
        found.p_value,
        "first",
    )
    page = (tmp_path / "page.html").read_text()
    assert "Over time" in page
    assert "What could have been found" in page
