"""``labcal calibrate`` with all of its options, on dots that were never in a picture."""

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from labcal.bench.detect.bias import bench_camera, bench_target, hand_poses, seen
from labcal.cameras.dot_image import dot_images
from labcal.correspond.detections_csv import detections_csv, read_detections
from labcal.rng import generator
from labcal.targets.places import read_places

Run = Callable[..., Any]


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Hold the dots of eight views of one camera, and their target."""
    folder = tmp_path_factory.mktemp("calibrate")
    target, camera = bench_target(), bench_camera()
    radii = 0.5 * target.outer_diameters_mm()
    images = [dot_images(camera, T, target.points(), radii) for T in hand_poses(camera, target, 5)[4::2]]
    noise = 0.02 * generator(5, "system").standard_normal((len(images), target.count, 2))
    dots = seen([image.centroid for image in images], images, noise, target)
    (folder / "dots.csv").write_text(detections_csv(dots))
    (folder / "target.yaml").write_text(target.model_dump_json())
    return folder


def words(folder: Path, *more: object) -> tuple[object, ...]:
    return ("calibrate", folder / "dots.csv", "--target", folder / "target.yaml", *more)


def test_free_dots_are_told_written_and_drawn(labcal: Run, folder: Path, tmp_path: Path) -> None:
    rig, arrows = tmp_path / "rig.json", tmp_path / "arrows.png"
    told = labcal(*words(folder, "--lens", "brown-k1k2", "--free-dots", "--overlay", arrows, "-o", rig))
    assert told.status == 0
    document = told.document
    sigma = document["cameras"]["only"]["sigma"]
    K, true = document["cameras"]["only"]["K"], bench_camera()
    assert set(sigma) == {"fx", "fy", "cx", "cy", "dist", "rotation_rad", "translation_mm"}
    for value, name, at in zip(
        (K[0][0], K[1][1], K[0][2], K[1][2]), ("fx", "fy", "cx", "cy"), range(4), strict=True
    ):
        assert abs(value - true.intrinsics[at]) < 5 * sigma[name]
    assert 0.05 < document["centre_bias_px"]["rms"] < document["centre_bias_px"]["max"] < 1.0
    shape = document["free_dots"]["shape"]
    assert document["free_dots"]["agreement"] is None
    assert shape["kept"] == []
    assert abs(shape["stretch_ppm"]["value"] or 0.0) < 500.0
    places = read_places(tmp_path / "rig-dots.json")
    assert np.linalg.norm(places.points() - bench_target().points(), axis=1).max() < 0.05
    assert arrows.read_bytes().startswith(b"\x89PNG")
    assert set(json.loads(rig.read_text())["cameras"]["only"]) == {"K", "lens", "dist", "T_cam_world", "size"}
    refused = labcal(*words(folder, "--lens", "brown-k1k2", "--free-dots", "-o", tmp_path / "rig.json"))
    assert refused.status == 2


def test_the_treatment_of_the_dots_is_told(labcal: Run, folder: Path, tmp_path: Path) -> None:
    by_itself, kept = tmp_path / "rig.json", tmp_path / "kept.json"
    told = labcal(*words(folder, "--lens", "brown-k1k2", "-o", by_itself))
    found = told.document["dot_places"]
    assert (found["asked"], found["treatment"]) == ("auto", "declared")
    assert found["why"] == "as declared: the residuals show no uneven print"
    assert not (tmp_path / "rig-dots.json").exists()
    told = labcal(*words(folder, "--lens", "brown-k1k2", "--keep-dots", "-o", kept))
    assert told.document["dot_places"]["asked"] == "declared"
    assert kept.read_bytes() == by_itself.read_bytes()
    refused = labcal(*words(folder, "--keep-dots", "--free-dots", "-o", tmp_path / "both.json"))
    assert refused.status == 2
    assert "not allowed with argument" in refused.said


def test_a_rig_is_started_from_and_kept(labcal: Run, folder: Path, tmp_path: Path) -> None:
    first, second, third = (tmp_path / f"{name}.json" for name in ("first", "second", "third"))
    assert labcal(*words(folder, "--lens", "brown-k1k2", "-o", first)).status == 0
    told = labcal(*words(folder, "--start", first, "-o", second))
    camera = told.document["cameras"]["only"]
    assert camera["lens"] == "brown-k1k2"  # that of the rig
    written = json.loads(first.read_text())["cameras"]["only"]
    np.testing.assert_allclose(camera["K"], written["K"], atol=0.01)
    told = labcal(*words(folder, "--start", first, "--fix-intrinsics", "-o", third))
    assert told.document["cameras"]["only"]["K"] == written["K"]
    assert told.document["cameras"]["only"]["sigma"]["fx"] == 0.0


def test_outliers_are_named(labcal: Run, folder: Path, tmp_path: Path) -> None:
    dots = read_detections(folder / "dots.csv")
    position = dots.position.copy()
    moved = np.flatnonzero(dots.ok)[[5, 300]]
    position[moved] += [[20.0, -8.0], [0.0, 6.0]]
    (tmp_path / "dots.csv").write_text(detections_csv(replace(dots, position=position)))
    told = labcal(
        "calibrate", tmp_path / "dots.csv", "--target", folder / "target.yaml", "--lens", "brown-k1k2",
        "-o", tmp_path / "rig.json",
    )  # fmt: skip
    assert told.status == 0
    assert told.document["outlier_count"] == 2
    for outlier, line, off in zip(told.document["outliers"], moved, ([20.0, -8.0], [0.0, 6.0]), strict=True):
        assert (outlier["view"], outlier["camera"]) == (dots.view[line], "only")
        assert [outlier["col"], outlier["row"]] == dots.index[line].tolist()
        np.testing.assert_allclose(outlier["off_px"], off, atol=0.2)


def test_wrong_use_is_told_before_anything_is_done(labcal: Run, folder: Path, tmp_path: Path) -> None:
    rig = tmp_path / "rig.json"
    for more, hint in (
        (("--fix-intrinsics",), "--start rig.json"),
        (("--overlay", tmp_path / "a.png", "--keep-dots"), "these dots are kept"),
        (("--lens", "prescription"), "nothing in it to calibrate"),
        (("--lens", "brown6"), "brown5"),
        (("--start", tmp_path / "none.json"), "cannot be read"),
    ):
        told = labcal(*words(folder, *more, "-o", rig))
        assert told.status == 2
        assert hint in told.said
        assert not rig.exists()
