"""Rendered pictures of whole prints: their codes tell the target, and dots are where the truth has them."""

from pathlib import Path

import numpy as np
import pytest

from labcal import pipeline
from labcal.scene.board import Board
from labcal.shoot.truth import read_true_dots
from labcal.targets.catalogue import load_target
from labcal.targets.print_scale import printed_to_scale
from tests.system.conftest import Run
from tests.system.printed_scene import ONE_OF_A_KIND, printed_scene


@pytest.mark.slow
@pytest.mark.parametrize("name", ONE_OF_A_KIND)
def test_rendered_prints_at_45_degrees_tell_their_target(labcal: Run, name: str, tmp_path: Path) -> None:
    target = load_target(name)
    scene = printed_scene(target, (1600, 1200), 0.85, 45.0, "still-2000")
    (tmp_path / "scene.yaml").write_text(scene.to_yaml())
    assert labcal("render", tmp_path / "scene.yaml", "-o", tmp_path / "shoot", "--spp", 8).status == 0
    pictures = sorted((tmp_path / "shoot" / "images").iterdir())
    told = labcal("detect", *pictures, "-o", tmp_path / "d.csv", "--workers", 1)
    assert told.status == 0
    assert told.document["target"] == name
    found = [image["dots"] for image in told.document["images"]]
    # A small coded dot may be missed: 98% of them are to be read.
    assert sum(found) >= (0.98 if name == "coded-8x6" else 1.0) * 3 * target.count


@pytest.mark.slow
@pytest.mark.parametrize("number", [None, 0])
def test_dots_of_a_scaled_print_are_where_the_truth_has_them(number: int | None, tmp_path: Path) -> None:
    scaled = printed_to_scale(load_target("rings-10x8"), (0.97, 1.02))
    scene = printed_scene(scaled, (500, 400), 0.85, 20.0, "machine-vision-5mp", Board(print_number=number))
    (tmp_path / "scene.yaml").write_text(scene.to_yaml())
    settings = pipeline.RenderSettings(spp=8, seed=1, views=1)
    shoot = pipeline.render(tmp_path / "scene.yaml", tmp_path / "shoot", settings)
    found = pipeline.detect(shoot)
    ok = found.where(found.ok)
    (true,) = read_true_dots(shoot.folder)
    places = dict(zip(map(tuple, true.index.tolist()), true.centroid, strict=True))
    off = ok.position - np.array([places[tuple(index)] for index in ok.index.tolist()])
    assert len(ok) == scaled.count
    assert np.abs(np.mean(off, axis=0)).max() < 0.03
    assert float(np.sqrt((off**2).mean())) < 0.06
