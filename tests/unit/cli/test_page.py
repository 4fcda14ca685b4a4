"""``--page`` of calibrate, fit and evaluate, and the page of inspect."""

import json
import re
from pathlib import Path

import pytest

from labcal import examples
from labcal.cli import main
from labcal.cli.status import ExitStatus


@pytest.fixture
def home(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.chdir(tmp_path)
    examples.detections().save("dots.csv")
    examples.points().save("points.csv")
    examples.rig().save("rig.json")
    return tmp_path


CALIBRATE = ["calibrate", "dots.csv", "--target", examples.TARGET, "--lens", "brown5"]


def sentence(page: str) -> str:
    """Return the verdict of a page."""
    (found,) = re.findall(r'<p class="sentence">([^<]*)</p>', Path(page).read_text(encoding="utf-8"))
    return found


def test_calibrate_gives_a_page_that_speaks_of_options_and_the_same_rig(
    home: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert home.is_dir()
    assert main([*CALIBRATE, "-o", "a.json", "--page", "page.html"]) == ExitStatus.DONE
    assert main([*CALIBRATE, "-o", "b.json"]) == ExitStatus.DONE
    assert Path("a.json").read_bytes() == Path("b.json").read_bytes()
    assert "--hold-out 2" in sentence("page.html")
    text = Path("page.html").read_text(encoding="utf-8")
    assert f"labcal {' '.join(CALIBRATE)} -o a.json --page page.html" in text
    capsys.readouterr()
    # Claimed before the work, like every output.
    assert main([*CALIBRATE, "-o", "c.json", "--page", "page.html"]) == ExitStatus.UNUSABLE
    assert "--force" in capsys.readouterr().err
    assert not Path("c.json").exists()
    assert main([*CALIBRATE, "-o", "same.html", "--page", "same.html"]) == ExitStatus.UNUSABLE
    assert main([*CALIBRATE, "-o", "d.json", "--page", "page.png"]) == ExitStatus.UNUSABLE
    assert "ends in .html" in capsys.readouterr().err


def test_evaluate_gives_a_page_of_the_same_errors(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "points.csv", "--target", examples.TARGET, "--rig", "rig.json"]
    assert main([*words, "--json"]) == ExitStatus.DONE
    plain = capsys.readouterr().out
    assert main([*words, "--json", "--page", "errors.html"]) == ExitStatus.DONE
    assert capsys.readouterr().out == plain
    rms = json.loads(plain)["length_error_mm"]["rms"]
    assert f"{rms:.2g} mm (RMS;" in sentence("errors.html")
    first = Path("errors.html").read_bytes()
    Path("errors.html").unlink()
    assert main([*words, "--json", "--page", "errors.html"]) == ExitStatus.DONE
    assert Path("errors.html").read_bytes() == first
    capsys.readouterr()
    assert main([*words, "--force"]) == ExitStatus.UNUSABLE
    assert "--force replaces a page" in capsys.readouterr().err
    assert main([*words, "--page", "points.csv"]) == ExitStatus.UNUSABLE
    assert home.is_dir()


def test_fit_gives_a_page_of_all_methods(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["fit", "dots.csv", "--target", examples.TARGET, "--lens", "brown5", "--no-rehearsal"]
    made = [*words, "--method", "dlt,affine,homography", "-o", "m.safetensors", "--page", "fit.html"]
    assert main(made) == ExitStatus.PARTIAL
    text = Path("fit.html").read_text(encoding="utf-8")
    for method in ("dlt", "affine", "homography"):
        assert f'<th scope="row" class="text">{method}</th>' in text
    assert "refused:" in text
    assert "surrogate validation was left out" in sentence("fit.html")
    assert home.is_dir()
    capsys.readouterr()


def test_inspect_gives_a_page_with_every_picture(home: Path, capsys: pytest.CaptureFixture[str]) -> None:
    examples.shoot(home / "shoot")
    assert main(["inspect", "shoot", "-o", "sheet.html", "--workers", "1", "--json"]) == ExitStatus.DONE
    assert json.loads(capsys.readouterr().out)["sheet"] == "sheet.html"
    text = Path("sheet.html").read_text(encoding="utf-8")
    assert text.count('<img src="data:image/jpeg') == 4
    assert "4 of 4 pictures can be used, with 352 dots" in text
    assert "labcal inspect shoot -o sheet.html" in text
