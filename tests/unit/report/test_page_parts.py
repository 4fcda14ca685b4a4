"""Parts of pages: what they hold is there once, escaped, and the same twice."""

import gzip
import json
import re
from base64 import b64decode
from pathlib import Path

import numpy as np
import pytest

from labcal import examples, pipeline
from labcal.errors import OutputError
from labcal.geometry.magnification import round_magnification
from labcal.geometry.poses import transform
from labcal.report.page.asset import Asset
from labcal.report.page.document import PAGE_KIND, Page, Section
from labcal.report.page.download import Download, table_download
from labcal.report.page.output import PageOutput, called, page_file
from labcal.report.page.plotly_figure import plotly_figure
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.provenance import Provenance
from labcal.report.page.table import Column, PageTable, Side
from labcal.report.space import Space
from labcal.report.target_outline import target_outline
from labcal.run.file_marks import Judgement
from labcal.targets.catalogue import load_target

HOSTILE = "</script><script>alert('x')</script> & \"more\""


def page(text: str) -> Page:
    table = PageTable(
        "t", text, [Column(text, Side.LEFT, text), Column("n")], [[text, "1"]], Download("t.csv", text)
    )
    return Page(
        text, text, text, [Section("One", [Prose((text,), Tone.NOTE), table])], Provenance(text, {}, {})
    )


def test_nothing_that_a_page_holds_is_taken_for_markup() -> None:
    text = page(HOSTILE).text()
    assert "<script>alert" not in text
    assert "alert(&#39;x&#39;)" in text


def unpacked(text: str, name: str) -> bytes:
    (packed,) = re.findall(f'<script type="application/gzip" id="{name}">([^<]*)</script>', text)
    return gzip.decompress(b64decode(packed))


def test_data_are_in_the_page_inert_and_whole_and_each_once() -> None:
    text = page(HOSTILE).text()
    assert unpacked(text, "file-t-csv").decode() == HOSTILE
    assert Asset("a", b"x" * 100).html() == Asset("a", b"x" * 100).html()
    twice = Page("t", "h", "l", page("a").sections * 2, Provenance("c", {}, {})).text()
    assert twice.count('id="file-t-csv"') == 1
    assert page("a").text() == page("a").text()


def test_a_page_may_fetch_nothing_from_anywhere() -> None:
    (policy,) = re.findall('Content-Security-Policy" content="([^"]*)"', page("a").text())
    sources = {word for rule in policy.split(";") for word in rule.split()[1:]}
    assert policy.startswith("default-src 'none'")
    assert sources == {"'none'", "'unsafe-inline'", "data:", "blob:"}


def test_a_page_is_replaced_by_force_unless_somebody_has_changed_it(tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    PageOutput(path).write(page("a"))
    assert PAGE_KIND.mark.judge(path.read_bytes()) is Judgement.AS_WRITTEN
    with pytest.raises(OutputError, match="force"):
        PageOutput(path).write(page("b"))
    PageOutput(path, force=True).write(page("b"))
    path.write_text(path.read_text(encoding="utf-8").replace("<h1>b", "<h1>c"), encoding="utf-8")
    with pytest.raises(OutputError, match="changed"):
        PageOutput(path, force=True).write(page("d"))


def test_a_page_has_the_ending_of_one() -> None:
    with pytest.raises(OutputError, match=r"ends in \.html"):
        page_file("page.png")


def test_provenance_names_what_was_read_and_how_to_make_it_again(tmp_path: Path) -> None:
    (tmp_path / "dots.csv").write_bytes(b"abc")
    found = Provenance.of("labcal x", ["dots.csv", "nowhere.csv", None], tmp_path)
    # Of "abc", from FIPS 180-2.
    assert found.inputs == {"dots.csv": "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad"}
    assert found.versions["numpy"] == np.__version__
    assert "labcal x" in found.html()
    call = called("fit", {"source": "shoot", "detections": None, "method": np.zeros(3), "lens": "brown5"})
    assert call == "labcal.pipeline.fit(source='shoot', method=<ndarray>, lens='brown5')"


@pytest.mark.parametrize(
    ("most", "expected"), [(1.0, 1.0), (4.9, 2.0), (730.0, 500.0), (0.3, 0.2), (5.0, 5.0)]
)
def test_magnifications_are_round_and_not_too_large(most: float, expected: float) -> None:
    assert round_magnification(most) == pytest.approx(expected)


@pytest.fixture
def space() -> Space:
    """The example's cameras, a target before them, and points with errors of 0.1 mm in depth."""
    rig, target = examples.rig(), load_target(examples.TARGET)
    T = np.diag([1.0, -1.0, -1.0, 1.0])
    T[:3, 3] = [0.0, 0.0, 600.0]
    points = transform(T, target.points())
    vectors = np.tile([0.0, 0.0, 0.1], (len(points), 1))
    cameras = {name: rig.camera(name) for name in rig.cameras}
    return Space(cameras, [transform(T, target_outline(target))], points, vectors, ["dot"] * len(points))


def test_error_vectors_are_magnified_as_is_said(space: Space) -> None:
    drawn = json.loads(plotly_figure(space))
    (vectors,) = [trace for trace in drawn["data"] if trace["meta"] == "error vectors"]
    z = vectors["z"]
    assert z[1] - z[0] == pytest.approx(0.1 * space.magnification, abs=1e-3)
    low, high = space.bounds
    assert 0.02 * (high - low).max() < z[1] - z[0] < 0.07 * (high - low).max()
    assert z[2] is None  # a gap


def test_the_view_from_a_camera_is_from_its_place_with_its_picture_upright(space: Space) -> None:
    drawn = json.loads(plotly_figure(space))
    scene = drawn["layout"]["scene"]
    ranges = np.array([scene[f"{axis}axis"]["range"] for axis in "xyz"])
    longest, middle = np.ptp(ranges, axis=1).max(), ranges.mean(axis=1)
    for name, direction in zip(space.cameras, drawn["directions"][4:], strict=True):
        camera = space.cameras[name]
        eye, centre, up = (
            np.array([direction[key][axis] for axis in "xyz"]) for key in ("eye", "center", "up")
        )
        np.testing.assert_allclose(eye * longest + middle, camera.centre, atol=1e-2)
        ahead = (centre - eye) / np.linalg.norm(centre - eye)
        np.testing.assert_allclose(ahead, camera.T_cam_world[2, :3], atol=1e-4)
        np.testing.assert_allclose(up, -camera.T_cam_world[1, :3], atol=1e-4)
    # Aspects are those of the axes, so that nothing is stretched.
    aspect = np.array([scene["aspectratio"][axis] for axis in "xyz"])
    np.testing.assert_allclose(aspect, np.ptp(ranges, axis=1) / longest, atol=1e-5)


def test_many_points_are_thinned_and_that_is_said(space: Space) -> None:
    thin = space.thinned(10)
    assert len(thin.points) == len(thin.vectors) == len(thin.labels) == 10
    assert space.thinned(10_000) is space


def test_a_page_of_a_calibration_from_python_says_how_it_was_made(tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    examples.detections().save(tmp_path / "dots.csv")
    pipeline.calibrate(examples.TARGET, tmp_path / "dots.csv", "brown5", page=path)
    text = path.read_text(encoding="utf-8")
    assert "labcal.pipeline.calibrate(source=" in text
    assert "dots.csv" in text
    assert "`hold_out=2`" in text  # a notebook speaks of arguments
    assert "Expect a 3-D error of" in text
    with pytest.raises(OutputError, match="force"):
        pipeline.calibrate(examples.TARGET, tmp_path / "dots.csv", "brown5", page=path)


def test_of_very_many_lines_a_page_holds_some_and_says_so() -> None:
    few = table_download("a.csv", ("n",), [range(10)])
    assert (few.file, few.text.count("\n")) == ("a.csv", 11)
    many = table_download("a.csv", ("n",), [range(150_000)])
    assert many.file == "a-1-of-3.csv"
    assert many.text.split()[1:4] == ["0", "3", "6"]
    assert many.text.count("\n") == 50_001
