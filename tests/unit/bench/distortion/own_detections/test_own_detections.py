"""Methods on detections of one's own: what is read, what is held out, figures, lines and refusals."""

import csv
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from labcal import pipeline
from labcal.bench.distortion import bench
from labcal.bench.distortion.bench import bench_distortion
from labcal.bench.distortion.lines import HEADER
from labcal.bench.distortion.own_detections.case import held_out_parts
from labcal.bench.distortion.own_detections.given import own_detections
from labcal.bench.distortion.own_detections.result import OwnResult, own_lines, own_table
from labcal.bench.distortion.own_detections.run import measured_detections
from labcal.bench.distortion.plan import load_plan
from labcal.bench.settings import BenchSettings
from labcal.calibrate.resection import lens_choice
from labcal.cameras.camera import Camera
from labcal.cameras.record import matrix4_record
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import detections_csv
from labcal.correspond.interop.corners_vnl import corners_text
from labcal.correspond.matching import match
from labcal.errors import InputError
from labcal.run.executor import open_executor
from labcal.run.progress import NoProgress
from labcal.shoot.dataset import Shoot, open_shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Poses = dict[str, np.ndarray]
NOISE_PX = 0.05


@pytest.fixture(autouse=True)
def one_lens(monkeypatch: pytest.MonkeyPatch) -> None:
    """Spare the choice among five lens models, which is not what is tested here."""
    monkeypatch.setattr(lens_choice, "OF_POINTS", ("brown5",))


def staged(home: Path, grid: DotGrid, poses: Poses, tested: tuple[str, ...] = ("pose-7",)) -> Shoot:
    """Write the manifest of a target on a stage."""
    home.mkdir()
    views = tuple(
        ViewEntry(
            name=name,
            images={camera: f"images/{name}_{camera}.png" for camera in ("left", "right")},
            role=Role.TEST if name in tested else Role.TRAIN,
            T_world_target_nominal=matrix4_record(T),
        )
        for name, T in poses.items()
    )
    size = CameraEntry(size=(640, 480))
    write_manifest(home, Manifest(target=grid, cameras={"left": size, "right": size}, views=views))
    return open_shoot(home)


@pytest.fixture
def grid(grid: DotGrid) -> DotGrid:
    """The usual grid, with one pitch along and across, as mrcal needs it."""
    return grid.model_copy(update={"pitch_y_mm": grid.pitch_x_mm})


@pytest.fixture
def dots(see: See, pair: dict[str, Camera], grid: DotGrid, poses: Poses) -> Detections:
    exact = see(pair, grid, poses)
    noise = NOISE_PX * np.random.default_rng(2).normal(size=exact.position.shape)
    covariance = np.tile(NOISE_PX**2 * np.eye(2), (len(exact), 1, 1))
    images = [f"{view}_{camera}.png" for view, camera in zip(exact.view, exact.camera, strict=True)]
    noisy = replace(exact, position=exact.position + noise, covariance=covariance, image=images)
    return noisy.where((noisy.position > 0.0).all(axis=1))  # mrcal takes a negative pixel for none


def measured(path: Path, folder: Path, methods: str = "dlt,bundle") -> OwnResult:
    plan = load_plan("smallest", [f"methods={methods}"])
    with open_executor(1) as executor:
        given = own_detections([str(path)])
        (found,) = measured_detections(given, plan, 0, folder, executor, NoProgress())
    return found


def test_methods_learn_from_training_views_and_are_measured_on_test_views(
    tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses
) -> None:
    shoot = staged(tmp_path / "shoot", grid, poses)
    (shoot.folder / "detections.csv").write_text(detections_csv(dots))
    found = measured(shoot.folder, tmp_path)
    assert (found.name, found.held_out) == ("shoot", (("pose-7",),))
    seen = match(dots, shoot.cameras).view
    assert found.trained == (seen != "pose-7").sum()
    dlt, bundle = found.methods
    assert bundle.n == bundle.predicted == (seen == "pose-7").sum()
    assert bundle.over_best == 1.0 < dlt.over_best
    model = pipeline.fit(shoot, dots, "dlt", pipeline.FitSettings(rehearsal=False))
    points = pipeline.reconstruct(model, dots, shoot.target).points  # as a user does it, by hand
    tested = points.view == "pose-7"
    at = points.index[tested, 1] * grid.cols + points.index[tested, 0]
    T = poses["pose-7"]
    error = points.point[tested] - (grid.points() @ T[:3, :3].T + T[:3, 3])[at]
    assert dlt.rmse_mm == pytest.approx(np.sqrt((error**2).sum(axis=1).mean()), rel=1e-9)
    assert bundle.coverage95 == bundle.covered / bundle.stated > 0.8
    assert dlt.model_misfit is True
    assert bundle.model_misfit is False


def test_without_test_views_every_view_is_held_out_once(
    tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses
) -> None:
    shoot = staged(tmp_path / "shoot", grid, poses, tested=())
    parts = held_out_parts(shoot, set(dots.views))
    assert len(parts) == 5
    assert sorted(view for part in parts for view in part) == sorted(poses)
    two = dots.where(np.isin(dots.view, ["pose-0", "pose-1"]))
    assert held_out_parts(shoot, set(two.views)) == [("pose-0",), ("pose-1",)]
    with pytest.raises(InputError, match="1 training views have a pose; at least 2 are needed"):
        held_out_parts(shoot, {"pose-3"})


def test_a_table_of_others_holds_what_our_own_does(
    tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses
) -> None:
    shoot = staged(tmp_path / "shoot", grid, poses)
    ours, theirs = shoot.folder / "mine.csv", shoot.folder / "corners.vnl"
    ours.write_text(detections_csv(dots))
    theirs.write_text(corners_text(dots, grid).text)
    given = own_detections([str(ours), str(theirs), str(shoot.folder), str(ours)])
    assert [one.name for one in given] == ["shoot-mine", "shoot-corners", "shoot", "shoot-mine-2"]
    one, other = (match(table.detections, shoot.cameras) for table in given[:2] if table.detections)
    assert one.view.tolist() == other.view.tolist()
    np.testing.assert_array_equal(one.index, other.index)
    np.testing.assert_allclose(one.X, other.X, atol=1e-9)
    np.testing.assert_allclose(one.covariance, other.covariance, rtol=1e-9)


def test_a_method_that_refuses_and_views_without_dots_have_their_reasons(
    tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses
) -> None:
    shoot = staged(tmp_path / "shoot", grid, poses)
    lost = replace(dots, flag=np.where((dots.view == "pose-7") & (dots.camera == "left"), "cut", dots.flag))
    (shoot.folder / "detections.csv").write_text(detections_csv(lost))
    found = measured(shoot.folder, tmp_path / "lost", "dlt")
    assert found.methods[0].reasons == ("No dot of the views held out was measured by all cameras.",)
    (line,) = own_lines([found], HEADER, 0)
    assert len(line) == len(HEADER)
    named = dict(zip(HEADER, line, strict=True))
    assert named["reason"] == found.methods[0].reasons[0]
    assert {"known_as", "model_misfit"} == {column for column, cell in named.items() if cell == ""}
    assert "dlt: No dot of the views held out" in str(own_table(found).caption)


@pytest.mark.slow
def test_lines_stand_in_the_tidy_table_and_two_processes_give_the_bytes_of_one(
    tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses, monkeypatch: pytest.MonkeyPatch
) -> None:
    shoot = staged(tmp_path / "shoot", grid, poses, tested=())
    (shoot.folder / "detections.csv").write_text(detections_csv(dots))
    settings = BenchSettings(
        plan="smallest", overrides=("methods=dlt,two-plane", "points=60"), detections=(str(shoot.folder),)
    )
    for cores in (1, 2):
        monkeypatch.setattr(bench, "usable_cores", lambda cores=cores: cores)
        bench_distortion(tmp_path / str(cores), settings, NoProgress())
    for file in ("results.csv", "results.json"):
        assert (tmp_path / "1" / file).read_bytes() == (tmp_path / "2" / file).read_bytes()
    with (tmp_path / "1" / "results.csv").open(encoding="utf-8") as text:
        lines = list(csv.DictReader(text))
    own = [line for line in lines if line["source"] == "detections"]
    assert [line["method"] for line in own] == ["dlt", "two-plane"]
    assert all(line["over_oracle"] == line["oracle_mm"] == "nan" for line in own)
    assert all(float(line["rmse_mm"]) > 0.0 and line["measured"] == "held-out" for line in own)
    assert {line["source"] for line in lines} == {"simulated", "detections"}


@pytest.mark.parametrize("table", ["", "detections.csv"])
def test_too_few_views_are_refused_before_the_folder_is_begun(
    table: str, tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses
) -> None:
    shoot = staged(tmp_path / "shoot", grid, {"pose-0": poses["pose-0"]})
    if table:
        (shoot.folder / table).write_text(detections_csv(dots.where(dots.view == "pose-0")))
    settings = BenchSettings(plan="smallest", overrides=("methods=dlt",), detections=(str(shoot.folder),))
    with pytest.raises(InputError, match="1 training views have a pose; at least 2 are needed"):
        bench_distortion(tmp_path / "out", settings, NoProgress())
    assert [path.name for path in tmp_path.iterdir()] == ["shoot"]


def test_what_cannot_be_measured_is_refused_at_once(
    tmp_path: Path, dots: Detections, grid: DotGrid, poses: Poses
) -> None:
    table = tmp_path / "dots.csv"
    table.write_text(detections_csv(dots))
    with pytest.raises(InputError, match=r"nothing says where the target .* Put the table into the folder"):
        own_detections([str(table)])
    with pytest.raises(InputError, match="does not exist"):
        own_detections([str(tmp_path / "nothing")])
    with pytest.raises(InputError, match="is not a shoot"):
        own_detections([str(tmp_path)])
    shoot = staged(tmp_path / "shoot", grid, poses)
    held = shoot.manifest.model_copy(
        update={
            "views": tuple(
                view.model_copy(update={"T_world_target_nominal": None}) for view in shoot.manifest.views
            )
        }
    )
    write_manifest(shoot.folder, held)
    with pytest.raises(InputError, match="held in the hand"):
        own_detections([str(shoot.folder)])
