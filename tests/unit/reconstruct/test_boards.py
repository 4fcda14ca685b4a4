"""Points of boards side by side: reconstructed, written, read and scored by board."""

import logging
from dataclasses import replace
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from plate import PLATE, T_A_B, in_turn, plate_poses, seen
from rich.console import Console

from labcal import pipeline
from labcal.calibrate.calibration import Calibration
from labcal.correspond.boards_points import (
    points_of_boards,
    points_on_target,
    with_known_lengths,
    with_views_of_boards,
)
from labcal.correspond.boards_table import in_one_frame, on_target
from labcal.correspond.detections import Detections
from labcal.correspond.interop.corners_vnl import corners_text
from labcal.correspond.points import Points
from labcal.correspond.points_csv import read_points
from labcal.errors import InputError
from labcal.geometry.poses import transform
from labcal.reconstruct.reconstruction import Reconstruction
from labcal.report.calibrate_result import calibrate_result, calibrate_table
from labcal.targets.board_set import Mounting


@pytest.fixture(scope="module")
def table() -> Detections:
    rng = np.random.default_rng(21)
    return seen(plate_poses(rng, 12), in_turn, rng)


@pytest.fixture(scope="module")
def made(table: Detections) -> Calibration:
    return pipeline.calibrate(PLATE, table, "brown-k1k2", hold_out=("v03", "v09"))


@pytest.fixture(scope="module")
def found(made: Calibration, table: Detections) -> Reconstruction:
    return pipeline.reconstruct(made.rig, table, PLATE)


def test_points_name_their_boards(found: Reconstruction, tmp_path: Path) -> None:
    points = found.points
    assert points.boards == ("a", "b")
    assert points.index.max(axis=0).tolist() == [5, 3]
    points.save(tmp_path / "points.csv")
    assert (tmp_path / "points.csv").read_text().splitlines()[1].endswith(",ok,a")
    assert read_points(tmp_path / "points.csv") == points
    numbered = points_on_target(points, PLATE)
    assert not numbered.boards
    assert points_of_boards(numbered, PLATE) == points
    assert points.to_pandas()["board"].tolist() == points.board.tolist()
    with pytest.raises(InputError, match="cannot keep apart"):
        points.to_xarray()


def test_boards_have_their_shape_and_their_place(found: Reconstruction) -> None:
    places = np.concatenate([PLATE.targets[0].points(), transform(T_A_B, PLATE.targets[1].points())])
    one = found.points.where(found.points.view == "v00")
    numbers = points_on_target(one, PLATE).index[:, 0]
    measured = np.linalg.norm(one.point[0] - one.point[-1])
    true = np.linalg.norm(places[numbers[0]] - places[numbers[-1]])
    assert abs(measured - true) < 3.5 * np.hypot(one.sigma_mm[0], one.sigma_mm[-1])


def test_corners_have_no_eccentricity(found: Reconstruction) -> None:
    assert found.eccentricity is None
    assert found.scale is not None
    assert abs(found.scale.ppm) < 3.5 * found.scale.sigma_ppm
    assert found.systematic is not None
    assert found.warnings == () or "no dot was measured" in found.warnings[0]


def test_lengths_between_boards_count_where_their_places_are_known(
    found: Reconstruction, made: Calibration
) -> None:
    alone = pipeline.evaluate(found.points, PLATE, rig=made.rig)
    together = pipeline.evaluate(found.points, rig=made.rig)
    assert set(alone.views_scored) == {"v03-a", "v03-b", "v09-a", "v09-b"}
    assert set(together.views_scored) == {"v03", "v09"}
    each = sum(n * (n - 1) // 2 for n in _counts(found, by_board=True))
    assert alone.n == each
    assert together.n == sum(n * (n - 1) // 2 for n in _counts(found, by_board=False))
    assert abs(alone.scale_ppm) < 2000.0


def _counts(found: Reconstruction, *, by_board: bool) -> list[int]:
    held = found.points.where(np.isin(found.points.view, ["v03", "v09"]))
    names = zip(held.view, held.board if by_board else held.view, strict=True)
    return np.unique([f"{view} {board}" for view, board in names], return_counts=True)[1].tolist()


def test_views_of_boards_that_move_separately() -> None:
    apart = PLATE.model_copy(update={"mounting": Mounting.SEPARATE})
    assert with_views_of_boards(["v"], apart) == ["v", "v-a", "v-b"]
    assert with_views_of_boards(None, apart) is None
    assert with_views_of_boards(["v"], PLATE.targets[0]) == ["v"]


def test_one_named_board_leaves_the_other_out_and_says_so(
    made: Calibration, table: Detections, caplog: pytest.LogCaptureFixture
) -> None:
    with caplog.at_level(logging.WARNING, "labcal"):
        found = pipeline.reconstruct(made.rig, table, PLATE.targets[1])
    assert "The target is 'b' alone: the dots of a are left out" in caplog.text
    assert not found.points.boards
    assert not any("calibrated with" in warning for warning in found.warnings)
    with caplog.at_level(logging.WARNING, "labcal"):
        pipeline.evaluate(found.points, PLATE.targets[1], rig=made.rig)


def test_points_without_boards_are_not_those_of_several(found: Reconstruction) -> None:
    points = found.points
    with pytest.raises(InputError, match="do not state their boards"):
        points_on_target(replace(points, board=np.full(len(points), "")), PLATE)
    with pytest.raises(InputError, match="states no board"):
        points_on_target(replace(points, board=np.where(points.board == "b", "", points.board)), PLATE)
    with pytest.raises(InputError, match="board 'c'"):
        points_on_target(replace(points, board=np.where(points.board == "b", "c", points.board)), PLATE)
    with pytest.raises(InputError, match=r"dot \(9, 0\) of board 'a', which has 6 x 4"):
        points_on_target(Points(["v"], [[9, 0]], np.zeros((1, 3)), [np.eye(3)], ["ok"], ["a"]), PLATE)


def test_views_are_split_only_where_lengths_are_not_known(found: Reconstruction, made: Calibration) -> None:
    numbered = points_on_target(found.points, PLATE)
    assert set(with_known_lengths(numbered, PLATE).views) >= {"v00-a", "v00-b"}
    placed = made.found.boards
    assert placed is not None
    assert with_known_lengths(numbered, placed) == numbered


def test_numbers_stay_in_their_view(table: Detections) -> None:
    apart = PLATE.model_copy(update={"mounting": Mounting.SEPARATE})
    assert in_one_frame(table, apart).views == table.views


def test_held_out_lengths_of_boards(table: Detections) -> None:
    errors = pipeline.evaluate_held_out(PLATE, table, "brown-k1k2", parts=2)
    assert errors.n > 500
    assert errors.length_error_mm.rms < 0.5


def test_methods_are_fitted_to_boards(table: Detections) -> None:
    quick = pipeline.FitSettings(lens="brown-k1k2", rehearsal=False)
    model = pipeline.fit(PLATE, table, "bundle", quick)
    found = pipeline.reconstruct(model, table, PLATE)
    assert found.points.boards == ("a", "b")
    assert found.eccentricity is None


def test_a_diagnosis_and_a_guide_take_one_board(table: Detections, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="A diagnosis takes one board, but 'plate' has several"):
        pipeline.diagnose(table, PLATE)
    settings = pipeline.CaptureSettings(guide=pipeline.GuideSettings())
    with pytest.raises(InputError, match="A guided capture takes one board"):
        pipeline.capture("folder:nowhere", tmp_path / "shoot", PLATE, settings)


def test_outliers_name_their_board(table: Detections) -> None:
    line = int(np.flatnonzero((table.board == "b") & table.ok)[5])
    off = table.position.copy()
    off[line] += 3.0
    wrong = replace(table, position=off)
    made = pipeline.calibrate(PLATE, wrong, "brown-k1k2")
    result = calibrate_result(made, on_target(wrong, PLATE), PLATE)
    first = result.outliers[0]
    assert (first.view, first.board, [first.col, first.row]) == (
        table.view[line],
        "b",
        table.index[line].tolist(),
    )
    assert first.place() == f"b {first.col}, {first.row}"
    assert result.centre_bias_px.max == 0.0
    console = Console(file=StringIO(), width=100)
    console.print(calibrate_table(result))
    assert "corrected eccentricity" not in console.file.getvalue()  # type: ignore[attr-defined]


def test_corners_vnl_of_one_board_among_several(table: Detections) -> None:
    text = corners_text(table, PLATE.targets[1]).text
    alone = on_target(table, PLATE.targets[1])
    assert text == corners_text(alone, PLATE.targets[1]).text
