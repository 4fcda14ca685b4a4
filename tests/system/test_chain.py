"""The commands end to end on small rendered shoots: from a scene to errors in millimetres."""

import csv
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.correspond.detections_csv import read_detections
from labcal.shoot.truth import read_true_dots

Run = Callable[..., Any]

DETECTIONS = "view,camera,image,width_px,height_px,col,row,x_px,y_px,var_xx,var_xy,var_yy,flag"
POINTS = "view,col,row,X_mm,Y_mm,Z_mm,cov_xx,cov_xy,cov_xz,cov_yy,cov_yz,cov_zz,flag"


def first_line(path: Path) -> str:
    return path.read_text().partition("\n")[0]


def true_errors(points: Path, shoot: Path) -> tuple[float, float, float]:
    """Return mean, RMS and largest distance of points of the test view from the truth, mm.

    Only of dots that truly were within the square of the trained ones, as `evaluate` counts.
    """
    with (shoot / "truth" / "dots.csv").open() as handle:
        true = {
            (line["view"], line["col"], line["row"]): np.array([float(line[f"{axis}_mm"]) for axis in "XYZ"])
            for line in csv.DictReader(handle)
        }
    trained = np.array([place for (view, *_), place in true.items() if view == "train"])
    low, high = trained.min(axis=0)[:2], trained.max(axis=0)[:2]
    lengths = []
    with points.open() as handle:
        for line in csv.DictReader(handle):
            place = true[line["view"], line["col"], line["row"]]
            if line["view"] != "train" and (low <= place[:2]).all() and (place[:2] <= high).all():
                found = np.array([float(line[f"{axis}_mm"]) for axis in "XYZ"])
                lengths.append(np.linalg.norm(found - place))
    assert len(lengths) == 12 * 9
    return float(np.mean(lengths)), float(np.sqrt(np.mean(np.square(lengths)))), max(lengths)


@pytest.mark.parametrize("shoot", ["stage", "handheld"])
def test_opencv_projects_the_truth_onto_the_true_centres(shoot: str, request: pytest.FixtureRequest) -> None:
    folder: Path = request.getfixturevalue(shoot)
    truth = json.loads((folder / "truth" / "truth.json").read_text())
    with (folder / "truth" / "dots.csv").open() as handle:
        lines = list(csv.DictReader(handle))
    compared = 0
    for name, camera in truth["cameras"].items():
        of_camera = [line for line in lines if line["camera"] == name and line["centre_x_px"] != "nan"]
        world = np.array([[float(line[f"{axis}_mm"]) for axis in "XYZ"] for line in of_camera])
        centre = np.array([[float(line[f"centre_{axis}_px"]) for axis in "xy"] for line in of_camera])
        T = np.array(camera["T_cam_world"])
        rotation, _ = cv2.Rodrigues(T[:3, :3])
        q, _ = cv2.projectPoints(world, rotation, T[:3, 3], np.array(camera["K"]), np.array(camera["dist"]))
        np.testing.assert_allclose(q[:, 0], centre, rtol=0, atol=1e-6)
        compared += len(centre)
    assert compared == 130 * 2 * len(truth["views"])


@pytest.mark.parametrize("shoot", ["stage", "handheld"])
def test_dots_are_found_where_they_truly_are(shoot: str, request: pytest.FixtureRequest) -> None:
    folder: Path = request.getfixturevalue(shoot)
    path: Path = request.getfixturevalue(f"{shoot}_dots")
    assert first_line(path) == DETECTIONS
    table = read_detections(path)
    distances = []
    for picture in read_true_dots(folder):
        found = table.where(table.ok & (table.view == picture.view) & (table.camera == picture.camera))
        assert len(found) >= 0.95 * picture.visible.sum()
        number = found.index[:, 1] * 13 + found.index[:, 0]
        assert picture.visible[number].all()
        distances.append(np.linalg.norm(found.position - picture.centroid[number], axis=1))
    distance = np.concatenate(distances)
    assert np.sqrt((distance**2).mean()) < 0.08
    assert distance.max() < 0.4


def test_detect_tells_of_each_picture(labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path) -> None:
    again, overlay = tmp_path / "again.csv", tmp_path / "overlay"
    told = labcal("detect", stage, "-o", again, "--overlay", overlay, "--workers", 2)
    assert told.status == 0
    assert set(told.document) == {"images", "indexed", "refused", "target", "target_read_from"}
    assert told.document["target_read_from"] is None  # the shoot states it
    assert (told.document["indexed"], told.document["refused"]) == (4, 0)
    for image in told.document["images"]:
        assert set(image) == {"image", "status", "reason", "dots", "expected", "numberings", "flags"}
        assert image["numberings"] == 1  # its rings say which way up it is
        assert image["flags"] == {}
        assert (image["status"], image["reason"], image["dots"], image["expected"]) == ("ok", None, 130, 130)
        assert image["image"].startswith(str(stage / "images"))
    assert again.read_bytes() == stage_dots.read_bytes()  # also with two workers
    assert sorted(path.name for path in overlay.glob("[!.]*")) == [
        f"{view}_{camera}.png" for view in ("test-shifted", "train") for camera in ("left", "right")
    ]


def test_loose_pictures_give_the_same_dots(
    labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path
) -> None:
    loose = [stage / "images" / f"train_{camera}.jpg" for camera in ("left", "right")]
    words = ("--target", "paper-13x10", "--cameras", "_left=left,_right=right", "--workers", 1)
    assert labcal("detect", *loose, "-o", tmp_path / "loose.csv", *words).status == 0
    lines = [line for line in stage_dots.read_text().splitlines() if not line.startswith("test-")]
    assert (tmp_path / "loose.csv").read_text().splitlines() == lines


def test_from_a_stage_to_millimetres(labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path) -> None:
    model = tmp_path / "model.safetensors"
    told = labcal("fit", stage, "--method", "affine,mlp,dlt", "-o", model, "--detections", stage_dots)
    assert told.status == 1  # the direct linear transform cannot learn from one plane
    affine, mlp, dlt = told.document["models"]
    assert (affine["method"], mlp["method"], dlt["method"]) == ("affine", "mlp", "dlt")
    assert dlt["file"] is None
    assert dlt["training_rmse_mm"] is None  # what does not apply is null
    assert "one plane" in dlt["error"]
    assert not (tmp_path / "model-dlt.safetensors").exists()
    rmse = {}
    for fitted in (affine, mlp):
        points = tmp_path / f"{fitted['method']}.csv"
        told = labcal("reconstruct", fitted["file"], stage_dots, "-o", points)
        assert told.status == 0
        assert told.document["n"] == 260
        assert first_line(points) == POINTS
        told = labcal("evaluate", points, stage, "--detections", stage_dots)
        assert told.status == 0
        errors = told.document
        assert {
            "n", "mean_signed_mm", "mae_mm", "rmse_mm", "p95_mm", "max_mm",
            "limit_mm", "coverage95", "alignment",
        } <= set(errors)  # fmt: skip
        assert (errors["n"], errors["alignment"]) == (12 * 9, "none")  # those within the trained hull
        assert len(errors["mean_signed_mm"]) == 3
        if fitted is affine:  # taught one plane, it calls Z exact and has no ellipsoids
            assert errors["coverage95"] is None
        else:
            assert 0.86 < errors["coverage95"] < 1.0  # 95%, four standard deviations of 108 points
        assert 0.05 < errors["limit_mm"] < 1.0
        mae, rms, largest = true_errors(points, stage)
        np.testing.assert_allclose(errors["mae_mm"], mae, rtol=1e-9)
        np.testing.assert_allclose(errors["rmse_mm"], rms, rtol=1e-9)
        np.testing.assert_allclose(errors["max_mm"], largest, rtol=1e-9)
        rmse[fitted["method"]] = errors["rmse_mm"]
        assert labcal("evaluate", points, stage).document["limit_mm"] is None
    assert rmse["mlp"] < 1.0 < rmse["affine"] < 10.0


def test_from_the_hand_to_millimetres(
    labcal: Run, handheld: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    rig, points = tmp_path / "rig.json", tmp_path / "points.csv"
    words = ("--target", "paper-13x10", "--lens", "brown-k1k2")
    told = labcal("calibrate", handheld_dots, *words, "-o", rig)
    assert told.status == 0
    assert {"cameras", "rms_px", "epipolar_rms_px"} <= set(told.document)
    assert list(told.document["cameras"]) == ["left", "right"]
    truth = json.loads((handheld / "truth" / "truth.json").read_text())["cameras"]
    for name, camera in told.document["cameras"].items():
        assert {"rms_px", "K", "lens", "dist", "views", "dots"} <= set(camera)
        assert np.shape(camera["K"]) == (3, 3)
        assert len(camera["dist"]) >= 5
        assert (camera["lens"], camera["views"]) == ("brown-k1k2", 3)
        assert camera["rms_px"] < 0.1
        np.testing.assert_allclose(camera["K"][0][0], truth[name]["K"][0][0], rtol=0.02)
    assert told.document["epipolar_rms_px"] < 0.25
    written = json.loads(rig.read_text())["cameras"]
    assert set(written["left"]) == {"K", "lens", "dist", "T_cam_world", "size"}
    np.testing.assert_array_equal(written["left"]["T_cam_world"], np.eye(4))
    assert labcal("reconstruct", rig, handheld_dots, "-o", points).status == 0
    assert first_line(points) == POINTS
    errors = labcal("evaluate", points, handheld, "--detections", handheld_dots).document
    assert errors["alignment"] == "rigid"
    assert errors["rmse_mm"] < 2.0
    assert 0.05 < errors["limit_mm"] < errors["rmse_mm"]
    # A rigid alignment takes most of the calibration's error of a rig of three views, and, where the rig is
    # known, its share of the covariances.
    evaluated = ("evaluate", points, handheld, "--detections", handheld_dots)
    assert labcal(*evaluated, "--rig", rig).document["coverage95"] > 0.9
    noise = ("--budget", "noise", "-o", points, "--force")
    assert labcal("reconstruct", rig, handheld_dots, *noise).status == 0
    assert 0.05 < labcal(*evaluated).document["coverage95"] < 0.5
    as_it_is = labcal("evaluate", points, handheld, "--alignment", "none").document
    assert as_it_is["alignment"] == "none"
    assert as_it_is["rmse_mm"] > 100.0  # the rig's world is its first camera
    lengths = labcal("evaluate", points, "--target", "paper-13x10").document
    assert {"length_error_mm", "epipolar_rms_px", "scale_ppm"} <= set(lengths)
    assert 0.0 < lengths["length_error_mm"]["rms"] < lengths["length_error_mm"]["max"] < 10.0
    assert labcal("evaluate", points).status == 2


def test_without_truth_the_bytes_are_the_same(
    labcal: Run, stage: Path, handheld: Path, stage_dots: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    # With truth, from the tables of dots; without, from the shoots themselves.
    seen, blind = tmp_path / "seen", tmp_path / "blind"
    for shoot, name in ((stage, "stage"), (handheld, "hand")):
        shutil.copytree(shoot, blind / name)
        shutil.rmtree(blind / name / "truth")
    seen.mkdir()
    fit, lens, dots = ("--method", "affine"), ("--lens", "brown-k1k2"), blind / "dots.csv"
    target = ("--target", "paper-13x10")
    assert labcal("fit", stage, *fit, "-o", seen / "model", "--detections", stage_dots).status == 0
    assert labcal("reconstruct", seen / "model", stage_dots, "-o", seen / "points.csv").status == 0
    assert labcal("calibrate", handheld_dots, *lens, *target, "-o", seen / "rig.json").status == 0
    assert labcal("detect", blind / "stage", "-o", dots, "--workers", 1).status == 0
    assert labcal("fit", blind / "stage", *fit, "-o", blind / "model", "--workers", 1).status == 0
    assert labcal("reconstruct", blind / "model", dots, "-o", blind / "points.csv").status == 0
    assert labcal("calibrate", blind / "hand", *lens, "-o", blind / "rig.json", "--workers", 1).status == 0
    assert dots.read_text() == stage_dots.read_text().replace(str(stage), str(blind / "stage"))
    for name in ("model", "points.csv", "rig.json"):
        assert (seen / name).read_bytes() == (blind / name).read_bytes(), name

    told = labcal("evaluate", blind / "points.csv", blind / "stage")
    assert told.status == 0
    assert {"length_error_mm", "epipolar_rms_px", "scale_ppm"} <= set(told.document)
    assert set(told.document["length_error_mm"]) == {"max", "rms"}
    assert 0 < told.document["length_error_mm"]["rms"] < told.document["length_error_mm"]["max"]
    assert told.document["epipolar_rms_px"] is None


def test_methods_learn_from_the_hand(
    labcal: Run, handheld: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    model, points = tmp_path / "model.safetensors", tmp_path / "points.csv"
    words = ("--method", "mlp,two-plane", "--lens", "brown-k1k2", "--no-rehearsal")
    target = ("--target", "paper-13x10")
    told = labcal("fit", handheld, "--detections", handheld_dots, *words, "-o", model)
    assert told.status == 0
    assert [fitted["expected"] for fitted in told.document["models"]] == [None, None]
    placed = told.document["handheld"]
    assert (placed["lens"], placed["views"], placed["free_dots"]) == ("brown-k1k2", 3, False)
    assert placed["rms_px"] < 0.25
    for method in ("mlp", "two-plane"):
        fitted = tmp_path / f"model-{method}.safetensors"
        told = labcal("reconstruct", fitted, handheld_dots, *target, "-o", points, "--force")
        assert told.status == 0
        lengths = labcal("evaluate", points, *target).document
        assert lengths["length_error_mm"]["rms"] < 2.0  # the board is 700 mm wide


def test_how_a_target_was_placed_is_not_said_twice(
    labcal: Run, stage: Path, stage_dots: Path, handheld_dots: Path, tmp_path: Path
) -> None:
    model = tmp_path / "model.safetensors"
    quick = ("--detections", stage_dots, "--no-rehearsal")
    for words, hint in (
        ((handheld_dots,), "--target NAME"),
        ((handheld_dots, "--target", "paper-13x10", "--detections", handheld_dots), "Give the table alone"),
        ((stage, "--free-dots"), "--free-dots is for a hand-held target"),
        ((stage, "--lens", "brown6"), "brown5"),
        ((stage, "--target", "paper-13x10"), "--target is for a hand-held target"),
        ((stage, *quick, "--lens", "brown5"), "--lens means nothing to mlp"),
    ):
        told = labcal("fit", *words, "--method", "mlp", "-o", model)
        assert told.status == 2
        assert hint in told.said
        assert not model.exists()


def test_the_choice_of_a_lens_may_be_named(
    labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path
) -> None:
    words = ("fit", stage, "--detections", stage_dots, "--method", "affine")
    assert labcal(*words, "-o", tmp_path / "unnamed").status == 0
    assert labcal(*words, "--lens", "auto", "-o", tmp_path / "named").status == 0
    assert (tmp_path / "named").read_bytes() == (tmp_path / "unnamed").read_bytes()


def test_the_same_command_twice_gives_the_same_bytes(
    labcal: Run, stage: Path, stage_dots: Path, tmp_path: Path
) -> None:
    for attempt in ("one", "two"):
        home = tmp_path / attempt
        home.mkdir()
        words = ("--method", "mlp", "--seed", 3, "--detections", stage_dots)
        assert labcal("fit", stage, *words, "-o", home / "model").status == 0
        assert labcal("reconstruct", home / "model", stage_dots, "-o", home / "points.csv").status == 0
    for name in ("model", "points.csv"):
        assert (tmp_path / "one" / name).read_bytes() == (tmp_path / "two" / name).read_bytes()
    assert (
        labcal(
            "fit", stage, "--method", "mlp", "--seed", 4, "--detections", stage_dots, "-o", tmp_path / "m"
        ).status
        == 0
    )
    assert (tmp_path / "m").read_bytes() != (tmp_path / "one" / "model").read_bytes()
