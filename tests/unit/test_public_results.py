"""A calibration, a model, a reconstruction and a shoot as a notebook has them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

import labcal
from labcal import Camera, Rig, examples, pipeline
from labcal.calibrate.calibration import Calibration
from labcal.cameras.interop.conversion import Conversion
from labcal.correspond.measure import Measurement
from labcal.correspond.sources import Source
from labcal.correspond.undistortion import Undistorted
from labcal.errors import InputError, OutputError
from labcal.estimators.affine import Affine
from labcal.estimators.model import Model, TrainingBox
from labcal.evaluate.against_truth import TruthErrors
from labcal.evaluate.scored_views import ScoredPart
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.report.bench import BenchResult, at_most
from labcal.report.inspection import InspectedCamera, InspectedPicture, Inspection
from labcal.report.reproduction import Reproduction
from labcal.shoot.manifest import Manifest
from labcal.shoot.pictures import write_single_picture

SIZES = ((640, 480), (640, 480))


def model(seed: int) -> Model:
    """Return an affine model of random data."""
    rng = np.random.default_rng(seed)
    X, Y = rng.uniform(0, 480, (20, 4)), rng.uniform(0, 100, (20, 3))
    return Model(Affine().fit(X, Y), ("left", "right"), SIZES, TrainingBox.of(X, Y), calibrated_on=("a",))


def test_a_model_is_equal_to_itself_loaded_and_to_no_other(tmp_path: Path) -> None:
    path = str(tmp_path / "model")
    given = model(1)
    given.save(path)
    assert Model.load(path) == given
    assert labcal.load_model(path) == given
    assert model(2) != given
    assert replace(given, calibrated_on=()) != given
    assert replace(given, warnings=("told once",)) == given  # these are not kept in the file
    with pytest.raises(OutputError):
        given.save(path)
    given.save(path, force=True)


@pytest.fixture(scope="module")
def calibration() -> Calibration:
    return pipeline.calibrate(labcal.load_target(examples.TARGET), examples.detections())


def test_a_calibration_shows_saves_and_lists_its_cameras(tmp_path: Path, calibration: Calibration) -> None:
    pytest.importorskip("pandas")
    made = calibration
    # Both coordinates have the noise of the example, and 1408 dots leave little to chance.
    assert made.found.rms_px == pytest.approx(np.sqrt(2) * examples.SIGMA_PX, rel=0.05)
    path = str(tmp_path / "rig.json")
    made.save(path)
    assert labcal.Rig.load(path) == made.rig
    assert repr(made).startswith("Calibration(cameras=['left', 'right'], lens=brown5, views=8, rms=0.028")
    table = made.to_pandas()
    assert table["dots"].tolist() == [704, 704]
    assert table["rms_px"].tolist() == [made.found.fits[name].rms_px for name in ("left", "right")]
    shown = replace(made, warnings=("<script>",))._repr_html_()
    assert "<script>" not in shown
    assert "&lt;script&gt;" in shown


def test_a_notebook_shows_names_as_words_and_no_table_without_rows(calibration: Calibration) -> None:
    shown = calibration._repr_html_()
    assert "<td>left, right</td>" in shown
    assert "<th>warnings</th>" not in shown
    assert "<th>warnings</th>" in replace(calibration, warnings=("one",))._repr_html_()


def test_a_notebook_shows_no_minus_before_zero() -> None:
    left = examples.rig().camera("left")
    T_cam_world = np.eye(4)
    T_cam_world[2, 3] = 1e-16
    camera = Camera(left.K, left.lens, left.dist, T_cam_world, left.size)
    assert camera.centre[2] < 0.0  # by its last digits
    assert "-0.0" not in Rig.of({"only": camera})._repr_html_()


def test_the_example_of_a_shoot_is_opened_by_a_second_call(tmp_path: Path) -> None:
    folder = tmp_path / "photos"
    first = examples.shoot(folder)
    written = {path: path.stat().st_mtime_ns for path in folder.rglob("*")}
    assert examples.shoot(folder) == first
    assert {path: path.stat().st_mtime_ns for path in folder.rglob("*")} == written
    with pytest.raises(OutputError, match="Choose another folder"):
        examples.shoot(folder, views=3)


@pytest.fixture(scope="module")
def reconstruction() -> Reconstruction:
    target = labcal.load_target(examples.TARGET)
    return pipeline.reconstruct(examples.rig(), examples.detections(), target)


def test_a_reconstruction_says_how_many_points_it_has(reconstruction: Reconstruction) -> None:
    found = reconstruction
    assert repr(found).startswith("Reconstruction(points=704, ok=704, median_residual=0.0")
    assert found == replace(found, points=replace(found.points))
    assert found != replace(found, miss_px=1.0)


def test_a_calibration_draws_its_residuals_by_view_and_over_each_picture(calibration: Calibration) -> None:
    figure = calibration.plot()
    figure.canvas.draw()
    by_view, left, right = figure.axes
    assert by_view.get_ylabel() == "RMS residual (px)"
    found, of = calibration.found, calibration.found.residuals
    for number, (name, line) in enumerate(zip(("left", "right"), by_view.lines[:2], strict=True)):
        drawn = np.asarray(line.get_ydata(), dtype=float)
        mine = (of.camera == number) & ~of.outlier
        square, view = (of.residual[mine] ** 2).sum(axis=1), of.view[mine]
        np.testing.assert_allclose(drawn, [np.sqrt(square[view == one].mean()) for one in range(8)])
        assert np.sqrt(square.mean()) == pytest.approx(found.fits[name].rms_in_rig_px)
    for axes, name in ((left, "left"), (right, "right")):
        assert axes.get_title().startswith(f"{name}: residuals x ")
        arrows = axes.collections[0]
        assert len(arrows.get_offsets()) == found.fits[name].dots


def test_a_reconstruction_is_drawn_saved_and_listed_as_its_points_are(
    tmp_path: Path, reconstruction: Reconstruction
) -> None:
    found = reconstruction
    found.save(str(tmp_path / "points.csv"))
    assert labcal.Points.load(tmp_path / "points.csv") == found.points
    assert found.plot().axes[0].get_xlabel() == "X (mm)"
    assert "<td>704</td>" in found._repr_html_()
    pandas = pytest.importorskip("pandas")
    pandas.testing.assert_frame_equal(found.to_pandas(), found.points.to_pandas())
    pytest.importorskip("xarray")
    assert found.to_xarray().equals(found.points.to_xarray())


def test_errors_are_tables_with_a_line_for_each_point_or_length(reconstruction: Reconstruction) -> None:
    pytest.importorskip("pandas")
    points = reconstruction.points.where([5, 90])
    error = np.array([[0.3, 0.0, 0.4], [0.0, 0.0, 0.2]])
    figures = (2, (0.15, 0.0, 0.3), 0.35, 0.381, 0.485, 0.5, 0.1, 0.5)
    table = TruthErrors(*figures, "none", "all", 0, ScoredPart(2, ("a",), 0), error, points).to_pandas()
    assert table["view"].tolist() == points.view.tolist()
    assert table[["col", "row"]].to_numpy().tolist() == points.index.tolist()
    assert table[["X_error_mm", "Y_error_mm", "Z_error_mm"]].to_numpy().tolist() == error.tolist()
    lengths = pipeline.evaluate(reconstruction.points, labcal.load_target(examples.TARGET))
    assert lengths.to_pandas()["error_mm"].tolist() == lengths.error.tolist()  # type: ignore[union-attr]


def test_checks_rows_and_pictures_are_tables(made_up: Reproduction) -> None:
    pytest.importorskip("pandas")
    bench = BenchResult(bench="solve", quick=True, checks=(at_most("a", 1.0, 2.0), at_most("b", 3.0, 2.0)))
    assert bench.to_pandas()["ok"].tolist() == [True, False]
    assert BenchResult(bench="solve", quick=True, checks=()).to_pandas().columns.tolist() == [
        "name", "value", "limit", "ok",
    ]  # fmt: skip
    rows = made_up.to_pandas()
    assert rows["exp"].tolist() == [row.exp for row in made_up.rows]
    assert rows["rmse_mm"].tolist() == [row.rmse_mm for row in made_up.rows]
    table = inspected().to_pandas()
    assert table["dots"].tolist() == [7, 0]
    assert table["reason"].isna().tolist() == [True, False]


def test_what_the_chain_returns_shows_itself_in_a_line_and_in_html(
    made_up: Reproduction, calibration: Calibration
) -> None:
    source = Source("a", "left", "<b>a_left.png", None)
    shown = {
        "Calibration(cameras=": calibration,
        "BenchResult(bench=detect, checks=1, failed=1": BenchResult(
            bench="detect", quick=False, checks=(at_most("<b>", 3.0, 2.0),)
        ),
        f"Reproduction(rows={len(made_up.rows)}": made_up,
        "Inspection(pictures=2, cameras=['left'], dots=7, refused=1)": inspected(),
        "Conversion(source=labcal, wanted=ros": Conversion(
            "labcal", "ros", ["a.yaml"], ["left"], None, "mm", None, ["<b>note"], []
        ),
        "Undistorted(folder=out, images=1": Undistorted("out", ["a.png"], ["left"], ["<b>b.png"], [], []),
        "Measurement(view=": Measurement(source, None, "it\nis <b>torn"),
    }
    for beginning, one in shown.items():
        assert repr(one).startswith(beginning)
        assert "\n" not in repr(one)
        assert "<b>" not in one._repr_html_()  # type: ignore[attr-defined]
        assert one == one  # noqa: PLR0124 -- by value
    assert inspected() == inspected()
    assert inspected() != replace(inspected(), warnings=("told",))


def inspected() -> Inspection:
    """Return two pictures at a glance, one of them refused."""
    good = InspectedPicture("a.png", "a", "left", None, 0.5, 0.0, 0.3, 7, None)
    torn = InspectedPicture("b.png", "b", "left", None, None, None, None, 0, "<b>torn")
    return Inspection((good, torn), {"left": InspectedCamera(0.5, 7)}, np.zeros((2, 2, 3), dtype=np.uint8))


def test_a_shoot_is_compared_shown_and_drawn(tmp_path: Path) -> None:
    view = {
        "name": "a",
        "images": {"left": "images/a_left.png"},
        "role": "train",
        "T_world_target_nominal": None,
    }
    manifest = {
        "target": labcal.load_target(examples.TARGET).model_dump(),
        "cameras": {"left": {"size": (40, 30)}, "right": {"size": (40, 30)}},
        "views": [view],
    }
    (tmp_path / "shoot.json").write_text(Manifest.model_validate(manifest).model_dump_json())
    (tmp_path / "images").mkdir()
    picture = np.zeros((30, 40), dtype=np.uint8)
    picture[3, 4] = 9
    write_single_picture(tmp_path / "images" / "a_left.png", picture)
    shoot = labcal.Shoot.load(str(tmp_path))
    assert shoot == labcal.open_shoot(tmp_path)
    assert shoot != shoot.showing(labcal.load_target("paper-13x10"))
    assert "target=plain-11x8, cameras=['left', 'right'], train=1, test=0" in repr(shoot)
    left, right = shoot.plot().axes
    drawn = np.asarray(left.images[0].get_array())
    assert np.unravel_index(drawn.argmax(), drawn.shape) == (3, 4)
    assert [text.get_text() for text in right.texts] == ["no picture"]


def test_a_shoot_is_opened_by_a_path_of_text_too(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="is not a shoot"):
        labcal.Shoot.load(str(tmp_path))
