"""Rendered pictures of coded dots and of a ChArUco board: errors as stated, by a chi-square test."""

from pathlib import Path

import numpy as np
import pytest
from scipy.stats import chi2

from labcal import pipeline
from labcal.shoot.truth import read_true_dots
from labcal.targets.catalogue import load_target

CODED = """
kind: coded-dots
name: coded-large
code: ring-23
first_mark: 3
cols: 6
rows: 5
pitch_mm: 60.0
dot_diameter_mm: 14.0
margin_mm: 30.0
"""


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["coded-dots", "charuco"])
def test_measured_places_scatter_as_stated_about_true_ones(kind: str, tmp_path: Path) -> None:
    (tmp_path / "coded.yaml").write_text(CODED)
    target = str(tmp_path / "coded.yaml") if kind == "coded-dots" else "charuco-12x9"
    shoot = pipeline.render(
        "still-handheld",
        tmp_path / "shoot",
        pipeline.RenderSettings(views=2, spp=16, seed=4),
        [f"target={target}"],
    )
    assert shoot.manifest.target == load_target(target)
    found = pipeline.detect(shoot)
    ok = found.where(found.ok)
    places, seen = {}, 0
    for picture in read_true_dots(shoot.folder):
        seen += int(picture.visible.sum())
        for index, centroid in zip(picture.index.tolist(), picture.centroid, strict=True):
            places[picture.view, picture.camera, *index] = centroid
    assert len(ok) > 0.95 * seen
    keys = zip(ok.view.tolist(), ok.camera.tolist(), *ok.index.T.tolist(), strict=True)
    off = ok.position - np.array([places[key] for key in keys])
    squares = np.einsum("ni,nij,nj->n", off, np.linalg.inv(ok.covariance), off)
    low, high = chi2.ppf([0.001, 0.999], 2 * len(off))
    assert low < squares.sum() < high
