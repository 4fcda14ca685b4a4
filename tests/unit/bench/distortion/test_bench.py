"""The whole benchmark on a small plan: its files, its bytes, and a regressor of one's own."""

import csv
import json
import re
import sys
from pathlib import Path

import pytest

import labcal
from labcal import pipeline
from labcal.bench.distortion import bench
from labcal.bench.distortion.result import DistortionResult, distortion_table
from labcal.cli import main
from labcal.cli.console import rendered
from labcal.run.json_text import plain_data

README = Path(labcal.__file__).parent.parent / "README.md"
SMALL = (
    *("families=brown", "strengths=0.4", "noise_px=0.1", "points=60", "methods=dlt,two-plane"),
    "faults=none",
)


def lines_of(folder: Path) -> list[dict[str, str]]:
    with (folder / "results.csv").open(encoding="utf-8") as text:
        return list(csv.DictReader(text))


@pytest.fixture
def own_method(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> tuple[str, list[str]]:
    """The regressor of the README in a file, and the words of the README's command after ``bench``."""
    section = README.read_text(encoding="utf-8").split("## Benchmark a regressor of your own")[1]
    code = re.search(r"```python\n(.*?)```", section, re.DOTALL)
    command = re.search(r"labcal bench (distortion .*?) -o", section)
    assert code is not None
    assert command is not None
    assert sum(1 for line in code[1].splitlines() if line.strip()) <= 15
    (tmp_path / "my_method.py").write_text(code[1], encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", [*sys.path])
    return "my_method:Cubic", command[1].split()


@pytest.mark.slow
def test_a_regressor_of_ones_own_by_one_command_and_by_one_call(
    own_method: tuple[str, list[str]], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    name, words = own_method
    monkeypatch.setattr(bench, "usable_cores", lambda: 1)
    few = [word for change in SMALL for word in ("--set", change)]
    status = main(["bench", *words, *few, "--seeds", "1", "-o", str(tmp_path / "command"), "--quiet"])
    assert status in {0, 1}
    settings = pipeline.BenchSettings(quick=True, methods=(name,), overrides=SMALL, seeds=1)
    made = pipeline.bench("distortion", tmp_path / "python", settings)
    for file in ("results.csv", "results.json", "index.html", "figures/error-brown-planes.svg"):
        assert (tmp_path / "command" / file).read_bytes() == (tmp_path / "python" / file).read_bytes()
    assert isinstance(made, DistortionResult)
    assert json.loads((tmp_path / "python" / "results.json").read_text()) == plain_data(made)
    lines = lines_of(tmp_path / "python")
    assert [line["method"] for line in lines[::2]] == ["dlt", "two-plane", name]
    assert {line["measured"] for line in lines} == {"within", "outside"}
    assert all(float(line["over_oracle"]) > 1.0 and not line["reason"] for line in lines)
    assert not any(name in check.name for check in made.checks)
    shown = rendered(distortion_table(made), sys.stdout)
    assert "two-plane" in shown
    assert max(map(len, shown.split("labcal bench")[0].splitlines())) <= 80


def test_report_makes_the_page_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench, "usable_cores", lambda: 1)
    settings = pipeline.BenchSettings(
        quick=True, overrides=(*SMALL[:-1], "faults=pitch,out-of-focus"), seeds=1
    )
    pipeline.bench("distortion", tmp_path / "out", settings)
    page = tmp_path / "out" / "index.html"
    before = page.read_bytes()
    page.unlink()
    for _ in ("missing", "there"):
        assert main(["report", str(tmp_path / "out")]) == 0
        assert page.read_bytes() == before
    page.write_bytes(before.replace(b"</body>", b"my notes</body>"))
    assert main(["report", str(tmp_path / "out")]) == 2
    assert b"my notes" in page.read_bytes()
    assert main(["report", str(tmp_path / "out"), "--force"]) == 0
    table = tmp_path / "out" / "results.csv"
    table.write_text(table.read_text().replace("brown,0.4", "brown,much", 1))
    assert main(["report", str(tmp_path / "out")]) == 2
    assert page.read_bytes() == before


def test_a_case_that_cannot_be_drawn_is_a_line_with_its_reason(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(bench, "usable_cores", lambda: 1)
    monkeypatch.setattr("labcal.bench.distortion.cell_data._seen", lambda _pair, q: q[:, 0, 0] > 1e9)
    settings = pipeline.BenchSettings(quick=True, overrides=SMALL, seeds=1)
    made = pipeline.bench("distortion", tmp_path / "out", settings)
    lines = lines_of(tmp_path / "out")
    assert {line["reason"] for line in lines} == {
        "The cameras of 'brown_0.4_0.1_60_planes_0' see none of the 60 training points."
    }
    assert made.checks[0].ok
    page = (tmp_path / "out" / "index.html").read_text(encoding="utf-8")
    assert "see none of the 60 training points" in page
    assert "--set methods=dlt,two-plane --set faults=none --seeds 1 -o DIR" in page


@pytest.mark.slow
def test_two_processes_give_the_bytes_of_one(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    overrides = (*SMALL[:-1], "faults=bend-1")
    settings = pipeline.BenchSettings(quick=True, overrides=overrides, seeds=2)
    for cores in (1, 2):
        monkeypatch.setattr(bench, "usable_cores", lambda cores=cores: cores)
        pipeline.bench("distortion", tmp_path / str(cores), settings)
    made = tmp_path / "1"
    assert (made / "figures" / "outside-brown-planes.svg").is_file()
    for file in [*made.glob("results.*"), made / "index.html", *(made / "figures").iterdir()]:
        assert file.read_bytes() == (tmp_path / "2" / file.relative_to(tmp_path / "1")).read_bytes(), file
