"""``labcal convert`` and ``labcal undistort`` end to end."""

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.bench.detect.bias import bench_camera, bench_target, hand_poses
from labcal.bench.hand_views import dots_at
from labcal.cameras.rig_file import read_rig
from labcal.correspond.detections_csv import detections_csv, read_detections
from labcal.geometry.poses import transform
from labcal.shoot.pictures import read_picture, write_picture
from labcal.targets.catalogue import load_target

Run = Callable[..., Any]


@pytest.fixture
def rig(stage: Path, tmp_path: Path) -> Path:
    """The true cameras of the rendered shoot."""
    path = tmp_path / "rig.json"
    cameras = json.loads((stage / "truth" / "truth.json").read_text())["cameras"]
    path.write_text(json.dumps({"cameras": cameras}))
    return path


@pytest.mark.parametrize(
    ("name", "wanted", "files"),
    [
        ("rig.cameramodel", None, ["rig-left.cameramodel", "rig-right.cameramodel"]),
        ("models", "mrcal", ["models/left.cameramodel", "models/right.cameramodel"]),
        ("stereo.yml", "opencv", ["stereo.yml"]),
        ("stereo.xml", "opencv", ["stereo.xml"]),
        ("camchain.yaml", "kalibr", ["camchain.yaml"]),
        ("info.yaml", "ros", ["info-left.yaml", "info-right.yaml"]),
        (
            "sparse",
            "colmap",
            [f"sparse/{one}.txt" for one in ("cameras", "images", "points3D", "rigs", "frames")],
        ),
        ("cal.xml", "dice", ["cal.xml"]),
        ("copy.json", None, ["copy.json"]),
    ],
)
def test_a_rig_goes_out_and_comes_back(
    labcal: Run, rig: Path, tmp_path: Path, name: str, wanted: str | None, files: list[str]
) -> None:
    words = () if wanted is None else ("--to", wanted)
    told = labcal("convert", rig, tmp_path / name, *words)
    assert told.status == 0
    assert told.document["files"] == [str(tmp_path / file) for file in files]
    assert told.document["cameras"] == ["left", "right"]
    assert told.document["source"] == "labcal"
    assert labcal("convert", rig, tmp_path / name, *words).status == 2
    assert labcal("convert", rig, tmp_path / name, *words, "--force").status == 0
    given = [tmp_path / name] if "/" in files[0] else [tmp_path / file for file in files]
    assert labcal("convert", *given, tmp_path / "back.json").status == 0
    meant, back = read_rig(rig), read_rig(tmp_path / "back.json")
    first = np.eye(4) if name in {"rig.cameramodel", "models", "sparse", "cal.xml", "copy.json"} else None
    for camera, record in meant.cameras.items():
        T = np.array(record.T_cam_world)
        if first is None:
            T = T @ np.linalg.inv(meant.cameras["left"].T_cam_world)
            assert "first camera, 'left', is the world" in told.said
        np.testing.assert_allclose(back.cameras[camera].T_cam_world, T, atol=1e-9)
        np.testing.assert_allclose(back.cameras[camera].dist, record.dist, rtol=1e-15)


def test_wrong_use_of_convert(labcal: Run, rig: Path, tmp_path: Path) -> None:
    for words, hint in (
        ((rig, tmp_path / "a.yaml"), "--to FORMAT"),
        ((rig, tmp_path / "a.yaml", "--to", "kalib"), "Did you mean 'kalibr'"),
        ((tmp_path / "none.xml", tmp_path / "a.json"), "No such file"),
        ((rig, tmp_path / "a.json", "--only", "middle"), "no camera in the rig named 'middle'"),
        ((rig, tmp_path / "nowhere" / "a.json"), "Create it first"),
        ((rig, tmp_path / "a.vnl"), "detections.csv"),
        ((tmp_path / "a.csv", tmp_path / "a.vnl"), "--target"),
    ):
        told = labcal("convert", *words)
        assert told.status == 2
        assert hint in told.said
    assert labcal("convert", rig, tmp_path / "one.json", "--only", "right").document["cameras"] == ["right"]


def test_detections_go_to_mrcal_and_back(labcal: Run, tmp_path: Path) -> None:
    camera, target = bench_camera(), bench_target()
    q = [camera.project(transform(T, target.points())).q for T in hand_poses(camera, target, 3)[:3]]
    dots = dots_at(q, [np.ones(target.count, dtype=bool)] * 3, target, camera.size, 0.02)
    (tmp_path / "dots.csv").write_text(detections_csv(dots))
    (tmp_path / "target.yaml").write_text(target.model_dump_json())
    words = ("--target", tmp_path / "target.yaml")
    told = labcal("convert", tmp_path / "dots.csv", tmp_path / "corners.vnl", *words)
    assert told.status == 0
    assert told.document["points"] == 3 * target.count
    assert "--object-spacing 0.009 --object-width-n 14 --object-height-n 10" in told.said
    back = ("convert", tmp_path / "corners.vnl", tmp_path / "back.csv", *words)
    assert "--size" in labcal(*back).said
    assert labcal(*back, "--size", "2048x1536").status == 0
    np.testing.assert_array_equal(read_detections(tmp_path / "back.csv").position, dots.position)


def test_dots_are_where_the_ideal_camera_images_them(
    labcal: Run, stage: Path, rig: Path, tmp_path: Path
) -> None:
    told = labcal("undistort", rig, stage, "--rectify", "-o", tmp_path / "flat")
    assert told.status == 0
    folder = tmp_path / "flat"
    assert set(told.document["images"]) == {p.relative_to(folder).as_posix() for p in folder.glob("images/*")}
    ideal = read_rig(folder / "rig.json")
    assert {camera.lens for camera in ideal.cameras.values()} == {"pinhole"}
    after = tmp_path / "after.csv"
    target = load_target("paper-13x10")
    options = ("--target", target.name, "--workers", 1)
    told = labcal("detect", folder / "images", *options, "--cameras", "_left=left,_right=right", "-o", after)
    assert told.document["refused"] == 0
    views = json.loads((stage / "truth" / "truth.json").read_text())["views"]
    T_world_target = {name: np.array(view["T_world_target"]) for name, view in views.items()}
    found = read_detections(after)
    found = found.where(found.ok)
    assert len(found) > 400
    off = []
    for name in found.cameras:
        camera = ideal.camera(name)
        for view in found.views:
            rows = (found.camera == name) & (found.view == view)
            p = transform(T_world_target[view], target.points(found.index[rows]))
            off.append(found.position[rows] - camera.project(p).q)
    assert np.sqrt((np.concatenate(off) ** 2).mean()) < 0.1


def test_bits_and_colours_are_kept_and_maps_remap(labcal: Run, rig: Path, tmp_path: Path) -> None:
    width, height = read_rig(rig).cameras["left"].size
    rng = np.random.default_rng(4)
    photo = cv2.GaussianBlur(rng.integers(0, 65536, (height, width, 3)).astype(np.uint16), (0, 0), 3.0)
    write_picture(tmp_path / "a_0.png", photo)
    words = ("undistort", rig, tmp_path / "a_0.png", "--cameras", "_0=left")
    assert labcal(*words, "-o", tmp_path / "out").status == 0
    made = read_picture(tmp_path / "out" / "images" / "a_left.png")
    assert (made.dtype, made.shape) == (np.uint16, (height, width, 3))
    places = read_picture(tmp_path / "out" / "maps" / "left.exr")
    assert places.dtype == np.float32
    again = cv2.remap(photo, places[..., 0].copy(), places[..., 1].copy(), cv2.INTER_LINEAR)
    seen = places[..., 2] == 1.0
    np.testing.assert_array_equal(made[seen], again[seen])


def test_pictures_that_do_not_fit_are_named(labcal: Run, rig: Path, tmp_path: Path) -> None:
    width, height = read_rig(rig).cameras["left"].size
    write_picture(tmp_path / "a_0.png", np.zeros((height, width), dtype=np.uint8))
    write_picture(tmp_path / "b_0.png", np.zeros((height, width - 1), dtype=np.uint8))
    sides = ("--cameras", "_0=left")
    told = labcal(
        "undistort", rig, tmp_path / "a_0.png", tmp_path / "b_0.png", *sides, "-o", tmp_path / "out"
    )
    assert told.status == 1
    assert told.document["images"] == ["images/a_left.png"]
    assert "it was scaled" in told.document["skipped"][0]
    for words, hint in (
        ((rig, tmp_path / "b_0.png", *sides), "The only picture cannot be used"),
        ((rig, tmp_path / "a_0.png"), "--cameras"),
        ((rig, tmp_path / "a_0.png", "--cameras", "_0=middle"), "only left, right"),
        ((rig, tmp_path / "none.png", *sides), "no picture or folder"),
        ((tmp_path / "a_0.png", tmp_path / "a_0.png", *sides), "it is a PNG picture, not a text"),
        ((rig, tmp_path / "a_0.png", *sides, "--distance-mm", "-3"), "more than 0"),
    ):
        told = labcal("undistort", *words, "-o", tmp_path / "never")
        assert told.status == 2
        assert hint in told.said
        assert not list(tmp_path.glob("never*"))
