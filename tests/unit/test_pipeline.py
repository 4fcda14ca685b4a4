"""What verbs do and say: roles of views, figures that are no check, results without a point, odd names."""

import contextlib
import io
import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal import pipeline
from labcal.calibrate.adjustment.state import Lenses
from labcal.calibrate.handheld import HandheldSettings
from labcal.cameras.camera import Camera
from labcal.cameras.record import CameraRecord, matrix4_record
from labcal.cameras.rig import Rig
from labcal.cameras.rig_file import read_rig, write_rig
from labcal.cli import main
from labcal.correspond.detections import Detections
from labcal.correspond.detections_csv import detections_csv
from labcal.errors import InputError
from labcal.shoot.dataset import Shoot, open_shoot, write_manifest
from labcal.shoot.manifest import CameraEntry, Manifest, Role, ViewEntry
from labcal.shoot.truth import TrueDots, TrueView, Truth, write_truth
from labcal.targets.grid import DotGrid

See = Callable[..., Detections]
Cameras = dict[str, Camera]
Poses = dict[str, np.ndarray]
CENTRES = HandheldSettings(eccentricity_rounds=0)
TESTED = ("pose-6", "pose-7")


@pytest.fixture
def shoot(tmp_path: Path, pair: Cameras, grid: DotGrid, poses: Poses) -> Shoot:
    """A target in the hand in eight views, two of which are to test on; with the truth."""
    home = tmp_path / "shoot"
    home.mkdir()
    views = tuple(
        ViewEntry(
            name=name,
            images={camera: f"images/{name}_{camera}.png" for camera in pair},
            role=Role.TEST if name in TESTED else Role.TRAIN,
            T_world_target_nominal=None,
        )
        for name in poses
    )
    size = CameraEntry(size=(640, 480))
    write_manifest(home, Manifest(target=grid, cameras=dict.fromkeys(pair, size), views=views))
    nowhere = np.full((grid.count, 2), np.nan)
    hidden = np.zeros(grid.count, dtype=bool)
    true = [
        TrueDots(
            name, camera, grid.indices(), grid.points() @ T[:3, :3].T + T[:3, 3], nowhere, nowhere, hidden
        )
        for name, T in poses.items()
        for camera in pair
    ]
    cameras = {name: CameraRecord.of(camera) for name, camera in pair.items()}
    true_views = {name: TrueView(T_world_target=matrix4_record(T)) for name, T in poses.items()}
    write_truth(home, Truth(cameras=cameras, views=true_views), true)
    return open_shoot(home)


@pytest.fixture
def dots(see: See, shoot: Shoot, pair: Cameras, grid: DotGrid, poses: Poses) -> Detections:
    exact = see(pair, grid, poses)
    noise = 0.02 * np.random.default_rng(2).normal(size=exact.position.shape)
    image = np.array(
        [f"{shoot.folder}/images/{v}_{c}.png" for v, c in zip(exact.view, exact.camera, strict=True)]
    )
    covariance = np.tile(0.02**2 * np.eye(2), (len(exact), 1, 1))
    return replace(exact, position=exact.position + noise, covariance=covariance, image=image)


def command(*words: object) -> tuple[int, Any, str]:
    """Return status, document and what was said."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        status = main([*map(str, words), "--json"])
    return status, json.loads(out.getvalue()), " ".join(err.getvalue().split())


def test_a_calibration_leaves_test_views_out_and_evaluation_scores_them(
    shoot: Shoot, dots: Detections, grid: DotGrid
) -> None:
    made = pipeline.calibrate(shoot, dots, "brown-k1k2", CENTRES)
    assert made.held_out == TESTED
    assert made.rig.calibrated_on == tuple(view for view in dots.views if view not in TESTED)
    every = pipeline.calibrate(shoot, dots, "brown-k1k2", CENTRES, hold_out="none")
    assert every.held_out == ()
    assert set(TESTED) <= set(every.calibrated_on)
    assert not any("keeps to test on" in warning for warning in every.warnings)
    more = pipeline.calibrate(shoot, dots, "brown-k1k2", CENTRES, hold_out=1)
    assert more.held_out == ("pose-3", *TESTED)
    points = pipeline.reconstruct(made.rig, dots).points
    errors = pipeline.evaluate(points, shoot, rig=made.rig.calibrated_on)
    assert (errors.views_scored, errors.views_calibrated_on, errors.warnings) == (TESTED, 0, ())
    by_role = pipeline.evaluate(points, shoot)  # the shoot does not know what a rig came from
    assert (by_role.views_scored, by_role.views_calibrated_on) == (TESTED, None)
    alone = points.where(~np.isin(points.view, TESTED))
    assert pipeline.evaluate(alone, shoot).views_calibrated_on is None  # of whichever rig they are
    circular = pipeline.evaluate(alone, shoot, rig=made.rig.calibrated_on)
    assert circular.views_calibrated_on == 6
    assert "circular" in circular.warnings[0]
    everything = pipeline.calibrate(grid, dots, "brown-k1k2", CENTRES)
    assert pipeline.evaluate(points, shoot, rig=everything.rig.calibrated_on).views_calibrated_on == 8


def test_the_command_says_which_views_it_left_out(shoot: Shoot, dots: Detections, tmp_path: Path) -> None:
    table, rig, points = tmp_path / "dots.csv", tmp_path / "rig.json", tmp_path / "points.csv"
    table.write_text(detections_csv(dots))
    lens = ("--lens", "brown-k1k2")
    status, told, said = command("calibrate", shoot.folder, "--detections", table, *lens, "-o", rig)
    assert (status, told["held_out"], len(told["calibrated_on"])) == (0, list(TESTED), 6)
    assert "held out, to be scored by 'labcal evaluate': pose-6, pose-7" in said
    assert command("reconstruct", rig, table, "--target", _target(shoot, tmp_path), "-o", points)[0] == 0
    status, told, _ = command("evaluate", points, shoot.folder)
    assert (status, told["views_scored"], told["views_calibrated_on"]) == (0, list(TESTED), None)
    status, told, _ = command("evaluate", points, shoot.folder, "--rig", rig)
    assert (status, told["views_scored"], told["views_calibrated_on"]) == (0, list(TESTED), 0)

    words = ("--target", _target(shoot, tmp_path), *lens, "--force")
    status, told, said = command("calibrate", table, *words, "-o", rig)
    assert (status, told["held_out"], len(told["calibrated_on"])) == (0, [], 8)
    assert "pose-6, pose-7 enter, which the shoot" in said
    status, told, said = command("evaluate", points, shoot.folder, "--rig", rig)
    assert told["views_calibrated_on"] == 8
    assert "circular" in said
    status, told, _ = command("calibrate", table, *words, "--hold-out", "pose-1,pose-4", "-o", rig)
    assert told["held_out"] == ["pose-1", "pose-4"]
    assert command("calibrate", table, *words, "--detections", table, "-o", rig)[0] == 2
    assert command("calibrate", table, *words, "--hold-out", "pose-9", "-o", rig)[0] == 2


def test_a_method_keeps_what_it_was_taught_for_evaluation(
    shoot: Shoot, dots: Detections, tmp_path: Path
) -> None:
    table, model, points = tmp_path / "dots.csv", tmp_path / "m.safetensors", tmp_path / "points.csv"
    table.write_text(detections_csv(dots))
    target, how = _target(shoot, tmp_path), ("--method", "bundle", "--lens", "brown-k1k2", "--no-rehearsal")
    words = (table, "--target", target, *how, "-o", model, "--force")
    status, told, said = command("fit", *words, "--hold-out", 2)
    assert (status, told["held_out"]) == (0, ["pose-2", "pose-6"])
    assert told["calibrated_on"] == [view for view in dots.views if view not in told["held_out"]]
    assert "held out, to be scored by 'labcal evaluate': pose-2, pose-6" in said
    assert command("reconstruct", model, table, "--target", target, "-o", points)[0] == 0
    status, scored, _ = command("evaluate", points, "--target", target, "--rig", model)
    assert (status, scored["views_scored"], scored["views_calibrated_on"]) == (0, told["held_out"], 0)
    status, told, said = command("fit", *words)
    assert (told["held_out"], len(told["calibrated_on"])) == ([], 8)
    assert "pose-6, pose-7 enter, which the shoot" in said
    _, scored, said = command("evaluate", points, "--target", target, "--rig", model)
    assert scored["views_calibrated_on"] == 8
    assert "circular" in said
    status, told, _ = command("fit", shoot.folder, "--detections", table, *how, "-o", model, "--force")
    assert (status, told["held_out"]) == (0, list(TESTED))
    status, _, said = command("evaluate", points, "--target", target, "--rig", table)
    assert status == 2
    assert "is neither a model from" in said


def test_pictures_that_teach_nothing_are_told(shoot: Shoot, dots: Detections, grid: DotGrid) -> None:
    spoilt = (dots.view == "pose-1") & (dots.camera == "left")
    flagged = replace(dots, flag=np.where(spoilt, "bad-fit", dots.flag))
    made = pipeline.calibrate(shoot, flagged, "brown-k1k2", CENTRES)
    (skipped,) = made.found.skipped
    assert skipped == "view 'pose-1' of camera 'left': none of its dots is measured (20 bad-fit)"
    assert any(skipped in warning for warning in made.warnings)
    found = pipeline.reconstruct(made.rig, flagged, grid)
    assert any("in 1 view: pose-1" in warning for warning in found.warnings)
    blind = replace(dots, flag=np.where(dots.camera == "right", "bad-fit", dots.flag))
    with pytest.raises(InputError, match="Camera 'right' has 6 views, but not one dot"):
        pipeline.calibrate(shoot, blind, "brown-k1k2", CENTRES)


def test_points_none_of_which_is_ok_are_no_success(shoot: Shoot, dots: Detections, tmp_path: Path) -> None:
    table, rig, points = tmp_path / "dots.csv", tmp_path / "rig.json", tmp_path / "points.csv"
    made = pipeline.calibrate(shoot, dots, "brown-k1k2", CENTRES)
    write_rig(rig, made.rig)
    off = np.where(dots.camera[:, None] == "right", [0.0, 8.0], 0.0)  # the right camera was knocked
    table.write_text(detections_csv(replace(dots, position=dots.position + off)))
    status, told, said = command(
        "reconstruct", rig, table, "--target", _target(shoot, tmp_path), "-o", points
    )
    assert (status, told["flags"]) == (1, {"model-misfit": 160})
    assert any("none of the points is flagged 'ok'" in warning for warning in told["warnings"])
    assert "none of the points is flagged 'ok'" in said
    status, told, _ = command("evaluate", points, shoot.folder)
    assert (status, told["n_ok"]) == (1, 0)


def test_a_rig_keeps_what_it_was_calibrated_from(shoot: Shoot, dots: Detections, tmp_path: Path) -> None:
    made = pipeline.calibrate(shoot, dots, "brown-k1k2", CENTRES)
    write_rig(tmp_path / "rig.json", made.rig)
    assert read_rig(tmp_path / "rig.json") == made.rig
    write_rig(tmp_path / "plain.json", made.found.rig)
    assert "calibrated_on" not in (tmp_path / "plain.json").read_text()
    kept = HandheldSettings(eccentricity_rounds=0, start=made.rig, lenses=Lenses.FIXED)
    moved = pipeline.calibrate(shoot, dots, None, kept, hold_out=["pose-0"])
    assert set(moved.rig.calibrated_on) == set(made.rig.calibrated_on)  # its lenses have seen pose-0
    assert command("convert", tmp_path / "rig.json", tmp_path / "left.json", "--only", "left")[0] == 0
    assert read_rig(tmp_path / "left.json").calibrated_on == made.rig.calibrated_on


def test_a_method_can_be_kept_from_views_too(shoot: Shoot, dots: Detections, grid: DotGrid) -> None:
    settings = pipeline.FitSettings("brown-k1k2", rehearsal=False, hold_out=["pose-0", "pose-4"])
    for source, views in ((grid, 6), (shoot, 4)):
        training = pipeline.training_of(source, dots, settings)
        learned = set(training.centred.data.view.tolist())
        assert len(learned) == views
        assert not {"pose-0", "pose-4"} & learned
    model = pipeline.fit(shoot, dots, "affine", settings)
    assert model.warnings == pipeline.training_of(shoot, dots, settings).warnings


def test_a_rig_to_start_from_does_not_go_with_trying_lenses(
    shoot: Shoot, dots: Detections, pair: Cameras
) -> None:
    start = HandheldSettings(start=Rig.of(pair))
    with pytest.raises(InputError, match="Leave `start` out"):
        pipeline.calibrate(shoot, dots, "auto", start)


def test_every_verb_that_takes_loose_pictures_asks_which_cameras_took_them(
    shoot: Shoot, dots: Detections, tmp_path: Path
) -> None:
    photos, target, rig = tmp_path / "photos", _target(shoot, tmp_path), tmp_path / "rig.json"
    photos.mkdir()
    for side in ("left", "right"):
        for number in range(3):
            (photos / f"{side}{number}.png").write_bytes(b"no picture")
    made = pipeline.calibrate(shoot, dots.where(dots.camera == "left"), "brown-k1k2", CENTRES)
    write_rig(rig, made.rig)  # of one camera
    for words in (
        ("detect", photos, "--target", target),
        ("inspect", photos, "--target", target),
        ("undistort", rig, photos),
    ):
        status, told, _ = command(*words, "-o", tmp_path / "out")
        assert status == 2
        assert "--cameras 'left*=left,right*=right'" in told["error"]["message"]
        assert "--cameras '*=camera'" in told["error"]["message"]
        assert not (tmp_path / "out").exists()
        status, told, _ = command(*words, "--cameras", "*=camera", "-o", tmp_path / "out")
        assert "names are those of" not in json.dumps(told)


def _target(shoot: Shoot, folder: Path) -> Path:
    path = folder / "target.yaml"
    path.write_text(shoot.target.model_dump_json())
    return path
