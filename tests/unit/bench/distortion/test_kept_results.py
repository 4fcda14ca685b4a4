"""``labcal report`` on folders of the benchmark of distortion: as made, copied, edited and damaged."""

import json
from collections.abc import Callable
from pathlib import Path
from shutil import copytree

import pytest

from labcal import pipeline
from labcal.bench.distortion import bench
from labcal.cli import main
from labcal.cli.status import ExitStatus

Change = Callable[[Path], object]


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of two methods on one cell."""
    folder = tmp_path_factory.mktemp("bench") / "made"
    settings = pipeline.BenchSettings(
        plan="smallest", overrides=("methods=dlt,affine", "points=40", "measured=within,outside")
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(bench, "usable_cores", lambda: 1)
        pipeline.bench("distortion", folder, settings)
    return folder


@pytest.fixture
def folder(made: Path, tmp_path: Path) -> Path:
    return Path(copytree(made, tmp_path / "copy"))


def text_changed(name: str, before: str, after: str) -> Change:
    """Return a function that replaces the first occurrence of a text in a file of a folder."""

    def change(folder: Path) -> None:
        text = (folder / name).read_text(encoding="utf-8")
        assert before in text
        (folder / name).write_text(text.replace(before, after, 1), encoding="utf-8")

    return change


def cell_changed(column: str, value: str) -> Change:
    """Return a function that changes a cell in the first line of ``results.csv``."""

    def change(folder: Path) -> None:
        table = folder / "results.csv"
        header, first, *rest = table.read_text(encoding="utf-8").splitlines()
        cells = first.split(",")
        assert cells[header.split(",").index(column)] != value
        cells[header.split(",").index(column)] = value
        table.write_text("\n".join([header, ",".join(cells), *rest, ""]), encoding="utf-8")

    return change


def without_last_line(folder: Path) -> None:
    table = folder / "results.csv"
    table.write_text(
        "".join(table.read_text(encoding="utf-8").splitlines(keepends=True)[:-1]), encoding="utf-8"
    )


def with_first_line_twice(folder: Path) -> None:
    table = folder / "results.csv"
    text = table.read_text(encoding="utf-8")
    table.write_text(text + text.splitlines()[1] + "\n", encoding="utf-8")


def test_the_page_that_is_there_is_made_again(folder: Path) -> None:
    page = folder / "index.html"
    before = page.read_bytes()
    assert main(["report", str(folder)]) == ExitStatus.DONE
    assert page.read_bytes() == before


def test_the_page_of_another_version_is_replaced(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    page = folder / "index.html"
    before = page.read_bytes()
    monkeypatch.setattr("labcal.bench.distortion.page.page._LEAD", "The words of another version.")
    assert main(["report", str(folder)]) == ExitStatus.DONE
    assert "The words of another version." in page.read_text(encoding="utf-8")
    monkeypatch.undo()
    assert main(["report", str(folder)]) == ExitStatus.DONE
    assert page.read_bytes() == before


def test_an_edited_page_is_kept_but_with_force(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    page = folder / "index.html"
    before = page.read_bytes()
    text_changed("index.html", "</body>", "my notes</body>")(folder)
    assert main(["report", str(folder)]) == ExitStatus.UNUSABLE
    assert "my notes" in page.read_text(encoding="utf-8")
    assert "--force" in capsys.readouterr().err
    assert main(["report", str(folder), "--force"]) == ExitStatus.DONE
    assert page.read_bytes() == before


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (cell_changed("family", "browm"), "Line 2 of"),
        (cell_changed("strength", "7.0"), "its known_as does not follow"),
        (cell_changed("fault", "bend-1"), "not of one run, or edited"),
        (cell_changed("method", "hybrid"), "not of one run, or edited"),
        (cell_changed("seed", "7"), "not of one run, or edited"),
        (cell_changed("rmse_mm", "0.5"), "its over_oracle does not follow"),
        (cell_changed("over_oracle", "1.0"), "its over_oracle does not follow"),
        (cell_changed("oracle_mm", "0.0"), "Line 2 of"),
        (cell_changed("covered", "9"), "its coverage95 does not follow"),
        (cell_changed("known_as", "k1 -9"), "its known_as does not follow"),
        (cell_changed("model_misfit", "2"), "its model_misfit does not follow"),
        (cell_changed("n", "-1"), "Line 2 of"),
        (without_last_line, "asks for 1 are missing, and 0 are there besides"),
        (with_first_line_twice, "asks for 0 are missing, and 1 are there besides"),
        (text_changed("results.json", '"first_seed": 0', '"first_seed": 5'), "not of one run, or edited"),
    ],
)
def test_edited_results_make_no_page(
    change: Change, said: str, folder: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (folder / "index.html").unlink()
    change(folder)
    assert main(["report", str(folder), "--json"]) == ExitStatus.UNUSABLE
    assert said in json.loads(capsys.readouterr().out)["error"]["message"]
    assert not (folder / "index.html").exists()
