"""``labcal measure`` of marks in pictures: points against the truth, the bytes of Python's, and messages."""

import json
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from labcal import examples, measure, pipeline, read_named_points, read_pixels
from labcal.bench.marks.specimen import Specimen, specimen
from labcal.cli import main
from labcal.distributions import chi2_quantile
from labcal.shoot.pictures import write_picture

MARKERS = "apriltag-36h11,ring-23,dots"
CAMERAS = "_left=left,_right=right"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> tuple[Specimen, Path]:
    folder = tmp_path_factory.mktemp("specimen")
    small = specimen(1, 0, 5, 3)
    small.rig.save(folder / "rig.json")
    (folder / "photos").mkdir()
    for name, picture in small.pictures.items():
        write_picture(folder / "photos" / f"shot_{name}.png", picture)
    return small, folder


@pytest.fixture(autouse=True)
def here(made: tuple[Specimen, Path], monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.chdir(made[1])
    yield
    for path in made[1].glob("out*"):
        path.rename(made[1] / f"old-{len(list(made[1].iterdir()))}-{path.name}")


def command(*words: str) -> int:
    return main(["measure", "rig.json", "photos", "--cameras", CAMERAS, "--workers", "1", *words])


def test_points_are_where_the_marks_are_within_their_ellipsoids(made: tuple[Specimen, Path]) -> None:
    assert command("--markers", MARKERS, "-o", "out.csv") == 0
    points = read_named_points("out.csv")
    truth = made[0]
    assert set(truth.named) <= set(points.name.tolist())
    off = []
    for name, p in zip(points.name.tolist(), points.point, strict=True):
        places = truth.named[name][None] if name in truth.named else truth.plain
        off.append(p - places[np.argmin(np.linalg.norm(places - p, axis=1))])
    assert sum("dot-" in name for name in points.name.tolist()) == len(truth.plain)
    error = np.array(off)
    squares = (error * np.linalg.solve(points.covariance, error[..., None])[..., 0]).sum(axis=1)
    assert np.linalg.norm(error, axis=1).max() < 0.6
    assert (squares < chi2_quantile(0.9999, 3)).all()


def test_a_command_and_python_give_the_same_bytes_and_so_do_the_pixels() -> None:
    words = ["--markers", "ring-23", "--dots", "--mark-diameter", "6", "--pixels", "out-pixels.csv"]
    assert command(*words, "-o", "out.csv", "--overlay", "out-overlays") == 0
    pictures = pipeline.open_pictures("photos", CAMERAS)
    search = pipeline.MarkSearch("ring-23,dots", mark_diameter=6.0)
    marks = pipeline.find_marks("rig.json", pictures, search)
    measure("rig.json", marks).save("out-python.csv")
    measure("rig.json", pictures, markers=search).save("out-at-once.csv")
    assert main(["measure", "rig.json", "out-pixels.csv", "-o", "out-again.csv"]) == 0
    for other in ("out-python.csv", "out-at-once.csv", "out-again.csv"):
        assert Path("out.csv").read_bytes() == Path(other).read_bytes()
    assert read_pixels("out-pixels.csv") == marks.pixels
    assert sorted(path.name for path in Path("out-overlays").glob("*.png")) == [
        "shot_left.png",
        "shot_right.png",
    ]


def test_the_document_tells_pictures_and_eccentricity(capfd: pytest.CaptureFixture[str]) -> None:
    assert command("--markers", "ring-23", "-o", "out.csv", "--json") == 0
    document = json.loads(capfd.readouterr().out)
    marks = document["marks"]
    assert [one["status"] for one in marks["images"]] == ["ok", "ok"]
    assert marks["images"][0]["marks"] == document["n"] == document["flags"]["ok"] == 5
    assert marks["eccentricity"]["corrected"] == 10
    assert 0.0 < marks["eccentricity"]["rms_px"] < 0.02
    assert marks["diameter_mm"] == pytest.approx(6.0, rel=0.02)


def test_a_picture_that_cannot_be_used_is_told_and_the_others_measured(
    made: tuple[Specimen, Path], capfd: pytest.CaptureFixture[str]
) -> None:
    Path("out-photos").mkdir()
    for name, picture in made[0].pictures.items():
        write_picture(f"out-photos/a_{name}.png", picture)
        write_picture(f"out-photos/b_{name}.png", np.full_like(picture, 200))
    write_picture("out-photos/c_left.png", made[0].pictures["left"][:300])
    Path("out-photos/c_right.png").write_bytes(b"no picture")
    words = ["measure", "rig.json", "out-photos", "--cameras", CAMERAS, "--markers", "ring-23", "--json"]
    assert main([*words, "--workers", "1", "-o", "out.csv"]) == 1
    document = json.loads(capfd.readouterr().out)
    assert (document["marks"]["measured"], document["marks"]["refused"]) == (2, 4)
    reasons = [one["reason"] for one in document["marks"]["images"]]
    assert reasons[:2] == [None, None]
    assert reasons[2].startswith("no-marks: no mark of 'ring-23' was found")
    assert "is 640 x 300 px, but camera 'left' was calibrated with pictures of 640 x 480 px" in reasons[4]
    assert document["flags"] == {"ok": 5}


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["photos", "--cameras", CAMERAS], "Name the marks to look for"),
        (["photos", "--markers", "ring-23"], "--cameras"),
        (["photos", "--cameras", "_left=left,_right=other", "--markers", "ring-23"], "camera in the rig"),
        (["photos", "--cameras", CAMERAS, "--markers", "ring-99"], "kind of marks"),
        (
            ["photos", "--cameras", CAMERAS, "--markers", "aruco-4x4-50"],
            "no mark of 'aruco-4x4-50' was found",
        ),
        (["photos", "--cameras", CAMERAS, "--markers", "ring-23", "--pixel-sigma", "1"], "Leave it out"),
        (["photos", "--cameras", CAMERAS, "--dots", "--mark-diameter", "0"], "--mark-diameter"),
        (["pixels.csv", "--mark-diameter", "3"], "--mark-diameter goes with marks in pictures"),
        (["pixels.csv", "--workers", "1"], "--workers goes with marks in pictures"),
        (["pixels.csv", "--set", "detect.mark.max_hidden_share=0.2"], "--set goes with marks in pictures"),
        (["pixels.csv", "--markers", "ring-23"], "pictures"),
        (["pixels.csv", "pixels.csv"], "One table of named pixels"),
    ],
)
def test_wrong_use_says_what_to_do(words: list[str], told: str, capfd: pytest.CaptureFixture[str]) -> None:
    examples.pixels().save("pixels.csv", force=True)
    assert main(["measure", "rig.json", *words, "-o", "out.csv"]) == 2
    assert told in capfd.readouterr().err.replace("\n", " ")
    assert not Path("out.csv").exists()


def test_a_noise_is_refused_before_marks_are_looked_for(
    capfd: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    looked_for: list[object] = []
    monkeypatch.setattr("labcal.pipeline.find_marks", lambda *given: looked_for.append(given))
    assert command("--markers", "ring-23", "--pixel-sigma", "1", "-o", "out.csv") == 2
    assert "--pixel-sigma would be dropped" in capfd.readouterr().err
    assert looked_for == []


def test_a_diameter_that_contradicts_the_pictures_is_warned_of(capfd: pytest.CaptureFixture[str]) -> None:
    assert command("--markers", "ring-23", "--mark-diameter", "9", "-o", "out.csv") == 0
    assert "times as large as stated" in capfd.readouterr().err.replace("\n", " ")


def test_plain_dots_of_another_size_are_told_with_theirs(capfd: pytest.CaptureFixture[str]) -> None:
    assert command("--dots", "--mark-diameter", "12", "-o", "out.csv") == 2
    told = capfd.readouterr().err.replace("\n", " ")
    assert "No plain dot has the stated diameter of 12 mm (--mark-diameter)" in told
    assert float(told.partition("have some ")[2].partition(" mm")[0]) == pytest.approx(6.0, rel=0.02)
