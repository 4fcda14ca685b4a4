"""The twin of a rendered shoot: residuals at noise level, and deliberate errors named."""

import json
import shutil
from dataclasses import dataclass
from pathlib import Path

import cv2
import numpy as np
import pytest

import labcal
from labcal import pipeline
from labcal.cameras.record import CameraRecord
from labcal.cameras.rig import Rig
from labcal.scene.model import Scene
from labcal.shoot.dataset import open_shoot
from labcal.shoot.truth import read_truth
from labcal.targets.places import DotPlaces

pytestmark = pytest.mark.slow
SIGMAS = 4.0
VIEWS = 3


@dataclass(frozen=True)
class Bench:
    """A shoot and its true rig."""

    shoot: Path
    rig: Rig


def _scene() -> Scene:
    camera = {"size": [560, 420], "focal_px": 680.0, "lens": "brown-k1k2", "dist": [-0.1, 0.02]}
    eyes = {"left": [-15.0, 0.0, 0.0], "right": [15.0, 0.0, 0.0]}
    return Scene.model_validate({
        "name": "small",
        "target": "rings-10x8",
        "cameras": {
            name: {**camera, "eye_mm": eye, "look_at_mm": [0.0, 65.0, 0.0], "up": [0.0, 0.0, 1.0]}
            for name, eye in eyes.items()
        },
        "placement": {
            "kind": "handheld", "train": VIEWS, "test": 0, "centre_mm": [0.0, 65.0, 0.0],
            "spread_mm": [3.0, 4.0, 3.0], "tilt_max_deg": 30.0, "roll_max_deg": 40.0,
        },
        "lamps": [
            {"kind": "panel", "centre_mm": [300.0, -300.0, 300.0], "look_at_mm": [0.0, 65.0, 0.0],
             "size_mm": [200.0, 200.0], "radiance": 9.0},
            {"kind": "panel", "centre_mm": [-300.0, -300.0, 0.0], "look_at_mm": [0.0, 65.0, 0.0],
             "size_mm": [200.0, 200.0], "radiance": 5.0},
            {"kind": "ambient", "radiance": 0.1},
        ],
        "room": {"floor_z_mm": -4000.0, "wall_y_mm": 4000.0, "table_z_mm": -3900.0},
        "photometry": {"format": "png", "tone_curve": "linear", "full_well_e": 8000.0},
        "spp": 64,
    })  # fmt: skip


@pytest.fixture(scope="module")
def bench(tmp_path_factory: pytest.TempPathFactory) -> Bench:
    """Four views, rendered once."""
    folder = tmp_path_factory.mktemp("twin") / "shoot"
    scene = folder.with_name("small.yaml")
    scene.write_text(_scene().to_yaml())
    pipeline.render(scene, folder)
    return Bench(folder, Rig(cameras=read_truth(folder).cameras))


def _twin(shoot: object, rig: Rig, target: object = None, folder: Path | None = None) -> labcal.Twin:
    return labcal.twin(shoot, rig, folder, target, pipeline.TwinSettings(spp=128))


def test_residuals_are_at_noise_level(bench: Bench, tmp_path: Path) -> None:
    found = _twin(bench.shoot, bench.rig, folder=tmp_path / "twin")
    assert found.is_explained, found.unexplained
    assert found.explained.level < 1.0 + SIGMAS * np.sqrt(2.0 / (2 * len(found.residuals)))
    # Positions as measured would hold the noise, which a field over the picture then seems to explain.
    rendered = np.concatenate([made.rendered for made in found.pictures])
    assert np.isin(found.residuals.q, rendered).mean() > 0.99
    pixels = sum(made.pixels.pixels for made in found.pictures)
    # Noise is measured in blocks, whose median knows the variance 0.64 times as well as all pixels would.
    assert abs(found.pixel_variance - 1.0) < SIGMAS * np.sqrt(2.0 / (0.64 * 0.5 * pixels)) + 0.02
    told = json.loads((tmp_path / "twin" / "twin.json").read_text())
    assert told["unexplained"] == []
    assert all(one["at_noise"] for one in told["pictures"])
    assert "Photographs beside their renderings" in (tmp_path / "twin" / "index.html").read_text()
    again = open_shoot(tmp_path / "twin" / "shoot")
    calibrated = pipeline.calibrate(again, lens="brown-k1k2")
    assert calibrated.found.rms_px < 2.0 * found.residuals.noise_px


def test_a_print_with_a_column_aside_is_named(bench: Bench) -> None:
    target = open_shoot(bench.shoot).target
    places = target.points()
    places[target.indices()[:, 0] == 6, 0] += 0.01
    none = np.zeros((len(places), 3, 3))
    wrong = DotPlaces.of(target, places, none, np.zeros(len(places), int), np.zeros(len(places), bool))
    found = _twin(bench.shoot, bench.rig, wrong)
    assert found.unexplained[0].kind == "print"
    assert found.unexplained[0].size == pytest.approx(10.0 / np.sqrt(10.0), rel=0.5)


def test_a_wrong_lens_is_named(bench: Bench) -> None:
    cameras = {}
    for name, one in bench.rig.cameras.items():
        dist = (one.dist[0] + 0.03, *one.dist[1:]) if name == "right" else one.dist
        cameras[name] = CameraRecord.model_validate({**one.model_dump(), "dist": dist})
    found = _twin(bench.shoot, Rig(cameras=cameras))
    assert found.unexplained[0].kind == "lens"


def test_a_picture_out_of_focus_is_named(bench: Bench, tmp_path: Path) -> None:
    shutil.copytree(bench.shoot, tmp_path / "shoot")
    shoot = open_shoot(tmp_path / "shoot")
    view = shoot.views()[1]
    path = str(shoot.folder / view.images["left"])
    soft = cv2.GaussianBlur(cv2.imread(path, cv2.IMREAD_GRAYSCALE), (0, 0), 1.0)
    noisy = soft + 2.0 * np.random.default_rng(0).standard_normal(soft.shape)
    cv2.imwrite(path, np.clip(np.rint(noisy), 0, 255).astype(np.uint8))
    found = _twin(shoot, bench.rig)
    blur = next(one for one in found.unexplained if one.kind == "blur")
    assert blur.pictures == (f"{view.name}/left",)
    assert blur.size == pytest.approx(np.hypot(0.6, 1.0) - 0.6, rel=0.1)


def test_edges_of_jpeg_pictures_are_at_noise_level(bench: Bench, tmp_path: Path) -> None:
    shutil.copytree(bench.shoot, tmp_path / "shoot")
    manifest = tmp_path / "shoot" / "shoot.json"
    for path in sorted((tmp_path / "shoot" / "images").glob("*.png")):
        picture = cv2.imread(str(path), cv2.IMREAD_UNCHANGED)
        cv2.imwrite(str(path.with_suffix(".jpg")), picture, [cv2.IMWRITE_JPEG_QUALITY, 90])
        path.unlink()
    manifest.write_text(manifest.read_text().replace(".png", ".jpg"))
    found = labcal.twin(tmp_path / "shoot", bench.rig, None, None, pipeline.TwinSettings(spp=64, views=1))
    assert found.is_explained, found.unexplained
    assert 0.7 < found.edge_variance < 1.15  # 1.35 where compression is left out


def test_edges_behind_a_mosaic_are_at_noise_level(tmp_path: Path) -> None:
    scene, shoot = tmp_path / "colour.yaml", tmp_path / "shoot"
    described = _scene()
    photometry = described.photometry.model_copy(update={"bayer": True})
    scene.write_text(described.model_copy(update={"photometry": photometry}).to_yaml())
    pipeline.render(scene, shoot)
    rig = Rig(cameras=read_truth(shoot).cameras)
    found = labcal.twin(shoot, rig, None, None, pipeline.TwinSettings(spp=64, views=1))
    assert found.is_explained, found.unexplained
    assert 0.85 < found.edge_variance < 1.25  # above 2 where the mosaic is left out
