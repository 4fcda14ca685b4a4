"""``labcal reproduce`` and ``labcal report``, on one row of each kind."""

import json
from pathlib import Path

import pytest

from labcal.report.row_verdict import RowVerdict

ROWS = ("01", "05", "18")
KEYS = {
    "exp", "solver", "seeds", "epochs", "paper_epochs", "mean_signed_m", "rel", "paper_abs_m", "paper_rel",
    "mae_mm", "rmse_mm", "p95_mm", "max_mm", "seconds", "verdict", "readings",
}  # fmt: skip


@pytest.fixture(scope="module")
def reproduced(labcal, tmp_path_factory: pytest.TempPathFactory) -> Path:  # noqa: ANN001 - a class of conftest.py
    """A folder with the results of a quick run."""
    folder = tmp_path_factory.mktemp("reproduced") / "out"
    told = labcal("reproduce", *ROWS, "--quick", "--workers", 1, "-o", folder)
    assert told.status == 0
    assert told.document == json.loads((folder / "results.json").read_text())
    return folder


def test_each_row_stands_beside_the_papers(reproduced: Path) -> None:
    document = json.loads((reproduced / "results.json").read_text())
    assert [row["exp"] for row in document["rows"]] == list(ROWS)
    assert document["not_reported"] == ["16"]
    assert document["quick"]
    assert document["restrictions"]
    for row in document["rows"]:
        assert set(row) >= KEYS
        assert row["mae_mm"] <= row["rmse_mm"] <= row["max_mm"]
    network, least_squares, pictured = document["rows"]
    assert abs(network["mean_signed_m"]) <= 1e-4  # without noise: at most the paper's error, or 0.1 mm
    assert network["verdict"] in {RowVerdict.MATCHES, RowVerdict.OTHER_EPOCHS, RowVerdict.LARGER}
    assert [reading["nearest"] for reading in document["least_squares"]].count(True) == 1
    assert least_squares["epochs"] is None
    assert {reading["reading"].split(",")[0] for reading in least_squares["readings"]} == {
        "affine",
        "quadratic",
        "homography",
    }
    assert pictured["rmse_mm"] < 2.0
    assert pictured["verdict"] == RowVerdict.CONTRADICTION


def test_the_page_holds_everything(reproduced: Path, labcal) -> None:  # noqa: ANN001 - as above
    page = (reproduced / "index.html").read_text()
    assert "data:image/" in page
    assert "quick run" in page
    (reproduced / "index.html").unlink()
    assert labcal("report", reproduced).status == 0
    assert (reproduced / "index.html").read_text() == page


def test_an_unfinished_run_is_taken_up(reproduced: Path, labcal) -> None:  # noqa: ANN001 - as above
    unfinished = reproduced.with_name("again.unfinished")
    again = reproduced.with_name("again")
    results = (reproduced / "results.json").read_text()
    reproduced.rename(unfinished)
    (unfinished / ".labcal-command").write_text(_command())
    lost = min((unfinished / "cases").iterdir())
    lost.unlink()
    told = labcal("reproduce", *ROWS, "--quick", "--workers", 1, "-o", again)
    assert told.status == 0
    assert (again / "cases" / lost.name).is_file()
    before, after = json.loads(results), told.document
    for row in (*before["rows"], *after["rows"]):
        for figures in (row, *row["readings"]):
            del figures["seconds"], figures["seconds_range"]
    assert before == after


def _command() -> str:
    from labcal.paper.reproduce import ReproduceSettings, _command  # noqa: PLC0415 - slow
    from labcal.run.begun import Begun  # noqa: PLC0415 - slow

    return Begun.now(_command(ReproduceSettings(experiments=ROWS, quick=True))).text()


def test_a_row_that_is_not_there_is_named(labcal, tmp_path: Path) -> None:  # noqa: ANN001 - as above
    told = labcal("reproduce", "99", "-o", tmp_path / "x")
    assert told.status == 2
    assert "no row, claim or study of the paper named '99'" in told.document["error"]["message"]
    told = labcal("reproduce", "16", "-o", tmp_path / "x")
    assert "reports no figures" in told.document["error"]["message"]
    assert list(tmp_path.iterdir()) == []
