"""``labcal measure``, and ``reconstruct`` of named pixels: the bytes of Python's, status and messages."""

import json
import time
from pathlib import Path

import numpy as np
import pytest

from labcal import NamedPixels, displacements, examples, measure, read_named_points, write_ply
from labcal.cli import main
from labcal.pipeline import MeasureSettings


@pytest.fixture(autouse=True)
def files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    examples.rig().save("rig.json")
    examples.pixels().save("pixels.csv")


FRAME = "points:origin,right-corner,upper-corner"


@pytest.mark.parametrize("verb", ["measure", "reconstruct"])
def test_a_command_and_python_give_the_same_bytes(verb: str) -> None:
    words = [verb, "rig.json", "pixels.csv", "--frame", FRAME, "-o", "points.csv", "--ply", "points.ply"]
    assert main(words) == 0
    found = measure("rig.json", "pixels.csv", settings=MeasureSettings(frame=FRAME))
    found.save("python.csv")
    write_ply("python.ply", found.points)
    assert Path("points.csv").read_bytes() == Path("python.csv").read_bytes()
    assert Path("points.ply").read_bytes() == Path("python.ply").read_bytes()
    assert read_named_points("points.csv") == found.points


def test_the_document_tells_residuals_and_the_frame(capfd: pytest.CaptureFixture[str]) -> None:
    assert main(["measure", "rig.json", "pixels.csv", "--frame", FRAME, "-o", "points.csv", "--json"]) == 0
    document = json.loads(capfd.readouterr().out)
    assert document["flags"] == {"ok": 5}
    assert document["triangulation_rms_px"] == pytest.approx(0.0107, abs=1e-4)
    assert document["expected_assumed"] is True  # the example's rig does not say what its calibration left
    assert document["frame"]["kind"] == "points"
    assert document["frame"]["rms_mm"] is None
    assert 0 < max(document["frame"]["place_sigma_mm"]) < 0.1


def test_points_without_a_place_are_status_1(capfd: pytest.CaptureFixture[str]) -> None:
    pixels = examples.pixels()
    pixels.where(pixels.point != "tip").save("some.csv")
    pixels.where((pixels.point != "tip") | (pixels.camera == "left")).save("few.csv")
    assert main(["measure", "rig.json", "some.csv", "-o", "some-points.csv"]) == 0
    assert main(["measure", "rig.json", "few.csv", "-o", "few-points.csv"]) == 1
    assert "flagged 'too-few-cameras'" in capfd.readouterr().err


def test_messages_speak_of_options(capfd: pytest.CaptureFixture[str]) -> None:
    pixels = examples.pixels()
    NamedPixels(pixels.view, pixels.camera, pixels.point, pixels.position).save("short.csv")
    assert main(["measure", "rig.json", "short.csv", "-o", "points.csv"]) == 2
    assert "--pixel-sigma 0.1" in capfd.readouterr().err
    assert main(["measure", "rig.json", "pixels.csv", "-o", "points.csv", "--pixel-sigma", "1"]) == 2
    assert "--pixel-sigma would be dropped" in capfd.readouterr().err
    assert main(["measure", "rig.json", "pixels.csv", "-o", "points.csv", "--frame", "board:x.csv"]) == 2
    assert "--target NAME" in capfd.readouterr().err
    assert main(["measure", "rig.json", "pixels.csv", "-o", "points.ply"]) == 2
    assert "--ply points.ply" in capfd.readouterr().err
    assert not Path("points.csv").exists()


def test_options_of_named_pixels_are_refused_with_dots(capfd: pytest.CaptureFixture[str]) -> None:
    examples.detections().save("dots.csv")
    for option, value in (("--pixel-sigma", "1"), ("--frame", FRAME), ("--frame-view", "v")):
        assert main(["reconstruct", "rig.json", "dots.csv", "-o", "points.csv", option, value]) == 2
        assert f"{option} goes with a table of named pixels" in capfd.readouterr().err
    assert main(["reconstruct", "rig.json", "dots.csv", "-o", "points.csv", "--ply", "points.ply"]) == 0


@pytest.mark.slow
def test_time_grows_with_the_number_of_points() -> None:
    """Reading that looks at every name again for each part of a table would take far longer."""
    rng, rig, seconds = np.random.default_rng(0), examples.rig(), []
    for n in (60_000, 240_000):
        p = rng.uniform([-90, -60, 540], [90, 60, 660], (n, 3))
        q = np.concatenate([rig.camera(name).project(p).q for name in rig.cameras])
        names = np.tile([f"p{i}" for i in range(n)], 2)
        NamedPixels(np.full(2 * n, "v"), np.repeat(list(rig.cameras), n), names, q).save(f"{n}.csv")
        begun = time.process_time()
        assert (
            main(["measure", "rig.json", f"{n}.csv", "--pixel-sigma", "0.05", "-o", f"{n}-points.csv"]) == 0
        )
        seconds.append(time.process_time() - begun)
    assert seconds[1] < 7.0 * seconds[0]


def test_neither_the_known_points_nor_a_pixel_table_is_overwritten() -> None:
    Path("known.csv").write_text("point,X_mm,Y_mm,Z_mm\norigin,0,0,0\ntip,1,0,0\nfar-corner,0,1,0\n")
    words = ["measure", "rig.json", "pixels.csv", "--frame", "rigid:known.csv", "--force"]
    for output in ("known.csv", "pixels.csv", "rig.json"):
        before = Path(output).read_bytes()
        assert main([*words, "-o", output]) == 2
        assert main([*words, "-o", "points.csv", "--ply", output]) == 2
        assert Path(output).read_bytes() == before


def test_displacements_and_scale_bars_are_those_of_python(capfd: pytest.CaptureFixture[str]) -> None:
    examples.moved_pixels().save("moved.csv")
    bar = "origin,tip,75.5,0.01"
    words = ["measure", "rig.json", "moved.csv", "-o", "points.csv", "--displacements", "since.csv"]
    words += ["--reference-view", "moved", "--scale-bar", bar, "--scale-sigma-ppm", "100"]
    assert main([*words, "--json"]) == 0
    found = measure(
        "rig.json", "moved.csv", settings=MeasureSettings(scale_bars=[bar], scale_sigma_ppm=100.0)
    )
    found.save("python.csv")
    displacements(found, "moved").save("python-since.csv")
    assert Path("points.csv").read_bytes() == Path("python.csv").read_bytes()
    assert Path("since.csv").read_bytes() == Path("python-since.csv").read_bytes()
    document = json.loads(capfd.readouterr().out)
    assert document["budget"]["kind"] == "noise"
    assert [bar["view"] for bar in document["scale_bars"]["bars"]] == ["block", "moved"]
    (view,) = document["displacements"]["views"]
    assert view["view"] == "block"
    assert view["rigid_displacement_mm"][0] == pytest.approx(-2.0, abs=0.1)
    assert main([*words, "--quiet"]) == 2  # nothing is overwritten
    assert main([*words, "--force"]) == 0
    words = capfd.readouterr().out
    assert "since.csv: displacements in 1 view since 'moved'" in words
    assert "2 measurements of scale bars" in words


def test_options_of_displacements_and_bars_are_refused_where_they_do_nothing(
    capfd: pytest.CaptureFixture[str],
) -> None:
    start = ["measure", "rig.json", "pixels.csv", "-o", "points.csv"]
    for words, why in (
        (["--reference-view", "block"], "--reference-view goes with --displacements"),
        (["--displacements", "d.csv"], "All points are of one view, 'block'"),
        (["--scale-sigma-ppm", "5"], "Give --scale-bar, too"),
        (["--scale-bar", "origin,tip,1"], "is no scale bar"),
        (["--budget", "full"], "or leave --budget out"),
    ):
        assert main([*start, *words]) == 2
        assert why in capfd.readouterr().err
        assert not Path("points.csv").exists()
