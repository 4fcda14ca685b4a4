"""What Python and the command line make is the same, verb by verb; those not here: `test_same_result.py`."""

import filecmp
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal import examples, pipeline
from labcal.cameras.rig_file import read_rig
from labcal.correspond.detections_csv import detections_csv
from labcal.errors import InputError, OutputError
from labcal.report.rehearsal_result import rehearse_result
from labcal.run.json_text import plain_data, to_json
from labcal.shoot.pictures import read_picture

Run = Callable[..., Any]
TIMES = {"run.json", ".labcal-made"}
"""Files that hold times, or a digest of the folder's name."""


def same_files(one: Path, other: Path, *, but: frozenset[str] = frozenset()) -> list[str]:
    """Compare two folders byte for byte, but for times; return the names."""
    names = [
        {
            str(path.relative_to(home))
            for path in home.rglob("*")
            if path.is_file() and path.name not in TIMES | but
        }
        for home in (one, other)
    ]
    assert names[0] == names[1]
    same, differing, strange = filecmp.cmpfiles(one, other, sorted(names[0]), shallow=False)
    assert (differing, strange) == ([], [])
    return same


def without_times(tree: Any) -> Any:  # noqa: ANN401 -- a JSON document
    """Return a document without the keys that hold seconds."""
    if isinstance(tree, list):
        return [without_times(item) for item in tree]
    if isinstance(tree, dict):
        return {key: without_times(item) for key, item in tree.items() if "seconds" not in key}
    return tree


def test_render(labcal: Run, handheld: Path, tmp_path: Path) -> None:
    settings = pipeline.RenderSettings(spp=16, views=3)
    shoot = pipeline.render("webcam-handheld", tmp_path / "shoot", settings)
    assert len(same_files(shoot.folder, handheld)) > 6
    # One view is enough to see that what is set otherwise is the same, too.
    settings = pipeline.RenderSettings(spp=1, views=1)
    changed = pipeline.render("webcam-handheld", str(tmp_path / "dark"), settings, ["noise=off"])
    words = ("--spp", 1, "--views", 1, "--set", "noise=off")
    assert labcal("render", "webcam-handheld", "-o", tmp_path / "off", *words).status == 0
    same_files(changed.folder, tmp_path / "off")


def test_a_script_that_renders_can_run_twice(labcal: Run, tmp_path: Path) -> None:
    settings = pipeline.RenderSettings(spp=1, views=1)
    first = pipeline.render("webcam-handheld", tmp_path / "shoot", settings)
    picture = next((tmp_path / "shoot" / "images").iterdir())
    when = picture.stat().st_mtime_ns
    assert pipeline.render("webcam-handheld", tmp_path / "shoot", settings) == first
    assert picture.stat().st_mtime_ns == when
    with pytest.raises(OutputError, match="`force=True`"):  # other pictures are wanted than are there
        pipeline.render("webcam-handheld", tmp_path / "shoot", pipeline.RenderSettings(spp=2, views=1))
    told = labcal("render", "webcam-handheld", "--spp", 1, "--views", 1, "-o", tmp_path / "shoot")
    assert told.status == 2
    assert "--force" in told.document["error"]["message"]
    (tmp_path / "shoot" / "notes.txt").write_text("mine")
    with pytest.raises(OutputError, match="exists already"):
        pipeline.render("webcam-handheld", tmp_path / "shoot", settings)


def test_inspect(labcal: Run, handheld: Path, tmp_path: Path) -> None:
    found = pipeline.inspect(handheld)
    found.save(tmp_path / "python.png")
    told = labcal("inspect", handheld, "-o", tmp_path / "command.png", "--workers", 1)
    assert told.status == 0
    assert (tmp_path / "python.png").read_bytes() == (tmp_path / "command.png").read_bytes()
    assert told.document == plain_data(found.document(tmp_path / "command.png"))
    assert (read_picture(tmp_path / "python.png") == found.sheet).all()


def test_detect_with_other_settings(labcal: Run, handheld: Path, handheld_dots: Path, tmp_path: Path) -> None:
    word = "detect.edge.band_px=3"
    settings = pipeline.detect_settings([word])
    dots = detections_csv(pipeline.detect(str(handheld), settings=settings))
    assert dots != handheld_dots.read_text()
    assert labcal("detect", handheld, "-o", tmp_path / "d.csv", "--set", word, "--workers", 1).status in (
        0,
        1,
    )
    assert (tmp_path / "d.csv").read_text() == dots
    told = labcal("detect", handheld, "-o", tmp_path / "e.csv", "--set", "detect.edge.band_pxx=3")
    assert told.status == 2
    assert "detect.edge.band_px" in told.document["error"]["message"]
    told = labcal("calibrate", handheld_dots, "--target", "paper-13x10", "-o", tmp_path / "r", "--set", word)
    assert told.status == 2
    assert "--set is for finding dots" in told.document["error"]["message"]


def test_convert(labcal: Run, handheld_dots: Path, tmp_path: Path) -> None:
    words = ("--target", "paper-13x10", "--lens", "brown-k1k2", "-o", tmp_path / "rig.json")
    assert labcal("calibrate", handheld_dots, *words).status == 0
    for ending, wanted in (("yml", "opencv"), ("yaml", "kalibr"), ("cameramodel", "mrcal")):
        one, other = tmp_path / f"python.{ending}", tmp_path / f"command.{ending}"
        settings = pipeline.ConvertSettings(to_format=wanted, only=["left"])
        made = pipeline.convert(str(tmp_path / "rig.json"), str(one), settings)
        told = labcal("convert", tmp_path / "rig.json", other, "--to", wanted, "--only", "left")
        assert told.status == 0
        assert one.read_bytes() == other.read_bytes()
        assert told.document == {**plain_data(made), "files": [str(other)]}
    one, other, table = tmp_path / "python.vnl", tmp_path / "command.vnl", tmp_path / "dots.csv"
    examples.detections().save(table)
    pipeline.convert(table, one, pipeline.ConvertSettings(target=examples.TARGET))
    assert labcal("convert", table, other, "--target", examples.TARGET).status == 0
    assert one.read_bytes() == other.read_bytes()
    with pytest.raises(InputError, match="`unit` goes with cameras"):
        pipeline.convert(table, tmp_path / "a.vnl", pipeline.ConvertSettings(unit="m"))
    told = labcal("convert", table, tmp_path / "a.vnl", "--unit", "m")
    assert "--unit goes with cameras" in told.document["error"]["message"]


def test_undistort(labcal: Run, handheld: Path, handheld_dots: Path, tmp_path: Path) -> None:
    words = ("--target", "paper-13x10", "--lens", "brown5", "-o", tmp_path / "rig.json")
    assert labcal("calibrate", handheld_dots, *words).status == 0
    settings = pipeline.UndistortSettings(rectify=True)
    made = pipeline.undistort(read_rig(tmp_path / "rig.json"), handheld, tmp_path / "python", settings)
    told = labcal("undistort", tmp_path / "rig.json", handheld, "-o", tmp_path / "command", "--rectify")
    assert told.status == 0
    assert told.document == {**plain_data(made), "folder": str(tmp_path / "command")}
    assert len(same_files(tmp_path / "python", tmp_path / "command")) == len(made.images) + 3


@pytest.mark.slow
def test_rehearse(labcal: Run, tmp_path: Path) -> None:
    plan = tmp_path / "plan.yaml"
    plan.write_text(to_json(examples.rig_plan().model_dump(mode="json", exclude_none=True)))
    made = pipeline.rehearse(plan, tmp_path / "python", pipeline.RehearseSettings(seed=3))
    told = labcal("rehearse", plan, "-o", tmp_path / "command", "--seed", 3)
    assert told.status == 0
    assert told.document == plain_data(rehearse_result(tmp_path / "command", made))
    assert set(same_files(tmp_path / "python", tmp_path / "command")) == {
        "index.html", "map.csv", "poses.csv", "rehearsal.json", "rig.json", "scene.yaml",
    }  # fmt: skip


def test_reproduce(labcal: Run, tmp_path: Path) -> None:
    settings = pipeline.ReproduceSettings(experiments=("01",), quick=True)
    made = pipeline.reproduce(tmp_path / "python", settings)
    told = labcal("reproduce", "01", "--quick", "--workers", 1, "-o", tmp_path / "command")
    assert told.status == 0
    rows = without_times(plain_data(made)["rows"])
    assert without_times(told.document["rows"]) == rows
    assert np.isfinite(rows[0]["rmse_mm"])


def test_bench(labcal: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("LABCAL_REAL_DATA", str(tmp_path / "nowhere"))
    made = pipeline.bench("detect", tmp_path / "python", pipeline.BenchSettings(groups=("real",)))
    told = labcal("bench", "detect", "--only", "real", "-o", tmp_path / "command")
    assert told.status == 0
    assert told.document == plain_data(made)
    with pytest.raises(InputError, match="no benchmark named 'detct'"):
        pipeline.bench("detct", tmp_path / "no")


def test_bench_distortion(labcal: Run, tmp_path: Path) -> None:
    small = ("families=brown", "strengths=0", "noise_px=0.1", "points=40", "methods=dlt", "faults=none")
    settings = pipeline.BenchSettings(quick=True, overrides=small, seeds=1)
    made = pipeline.bench("distortion", tmp_path / "python", settings)
    options = [word for change in small for word in ("--set", change)]
    told = labcal("bench", "distortion", "--quick", *options, "--seeds", 1, "-o", tmp_path / "command")
    assert told.status == (1 if made.failed else 0)
    assert told.document == plain_data(made)
    for file in ("results.csv", "results.json"):
        assert (tmp_path / "python" / file).read_bytes() == (tmp_path / "command" / file).read_bytes()
