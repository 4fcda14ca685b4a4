"""Rendered pictures pass the mosaic of the camera that they are compared with."""

from pathlib import Path

import numpy as np

from labcal.guide.twin.dot_windows import BlurredShare
from labcal.guide.twin.mosaic import behind_mosaic, green_behind_mosaic
from labcal.guide.twin.rendered_scene import rendered_scene
from labcal.render.film import Cells
from labcal.render.paper_share import SharpShare
from labcal.scene.catalogue import load_scene


def test_smooth_light_passes_a_mosaic_and_edges_differ() -> None:
    light = np.tile(np.linspace(10.0, 50.0, 40, dtype=np.float32), (30, 1))
    for seen in behind_mosaic([light] * 3):
        np.testing.assert_allclose(seen[2:-2, 2:-2], light[2:-2, 2:-2], atol=1e-4)
    sharp = np.tile(np.float32(np.arange(40) > 19), (30, 1))
    no_cells = Cells(np.zeros((0, 1, 1), np.float32), None)
    step = BlurredShare.of(SharpShare.of(sharp, np.zeros(0, np.int64), no_cells), 0.8)
    seen = green_behind_mosaic(step)
    off = np.abs(seen.share - step.share)
    assert off[:, :14].max() < 1e-6
    assert off[:, 17:23].max() > 0.02
    assert off[1::2, 0::2].max() == 0.0  # green pixels
    assert seen.by_blur is step.by_blur


def test_the_scene_of_a_shoot_tells_of_its_mosaic(tmp_path: Path) -> None:
    assert rendered_scene(tmp_path) is None
    truth = tmp_path / "truth"
    truth.mkdir()
    for name, wanted in (("webcam-handheld", True), ("still-handheld", False)):
        (truth / "scene.yaml").write_text(load_scene(name).to_yaml())
        scene = rendered_scene(tmp_path)
        assert scene is not None
        assert scene.photometry.bayer is wanted
    (truth / "scene.yaml").write_text("no scene: [")
    assert rendered_scene(tmp_path) is None
