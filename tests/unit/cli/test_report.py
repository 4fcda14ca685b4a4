import json
from pathlib import Path

import numpy as np
import pytest

from labcal.cli import main
from labcal.cli.status import ExitStatus
from labcal.report.reproduction import Reproduction
from labcal.report.reproduction_page import reproduction_page
from labcal.run.json_text import to_json
from labcal.shoot.pictures import write_picture


@pytest.fixture
def folder(tmp_path: Path, made_up: Reproduction) -> Path:
    (tmp_path / "shoots").mkdir()
    write_picture(tmp_path / "shoots" / "a.png", np.full((30, 40, 3), 90, np.uint8))
    (tmp_path / "results.json").write_text(to_json(made_up))
    return tmp_path


def test_the_page_is_made_and_made_again(
    folder: Path, made_up: Reproduction, capsys: pytest.CaptureFixture[str]
) -> None:
    page = folder / "index.html"
    for _ in range(2):
        assert main(["report", str(folder), "--json"]) == ExitStatus.DONE
        assert json.loads(capsys.readouterr().out) == {"page": str(page), "missing_pictures": []}
        assert page.read_text(encoding="utf-8") == reproduction_page(made_up, folder)


def test_a_missing_picture_is_a_page_in_part(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "shoots" / "a.png").unlink()
    assert main(["report", str(folder), "--json"]) == ExitStatus.PARTIAL
    told = capsys.readouterr()
    assert json.loads(told.out)["missing_pictures"] == ["shoots/a.png"]
    assert "shoots/a.png" in told.err


@pytest.mark.parametrize(
    ("content", "said"),
    [
        (None, "labcal reproduce"),
        ("{", "is not valid JSON"),
        ('{"rows": []}', "not_reported"),
        ("[]", "not a"),
    ],
)
def test_a_folder_without_results(
    tmp_path: Path, content: str | None, said: str, capsys: pytest.CaptureFixture[str]
) -> None:
    if content is not None:
        (tmp_path / "results.json").write_text(content)
    assert main(["report", str(tmp_path)]) == ExitStatus.UNUSABLE
    assert said in capsys.readouterr().err
    assert not (tmp_path / "index.html").exists()


def test_a_page_that_somebody_has_edited_is_kept(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = folder / "index.html"
    assert main(["report", str(folder), "--json"]) == ExitStatus.DONE
    page.write_text(page.read_text(encoding="utf-8").replace("</body>", "my notes</body>"), encoding="utf-8")
    assert main(["report", str(folder), "--json"]) == ExitStatus.UNUSABLE
    assert "my notes" in page.read_text(encoding="utf-8")
    assert "--force" in capsys.readouterr().err
