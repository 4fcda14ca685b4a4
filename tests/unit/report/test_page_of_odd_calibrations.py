"""Pages of calibrations that are unlike others: one camera, parallel rays, freed dots, contradictions."""

from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np
import pytest

from labcal.calibrate.calibrated import calibrated
from labcal.calibrate.handheld import HandheldSettings
from labcal.cameras.camera import Camera
from labcal.correspond.detections import Detections
from labcal.geometry.poses import from_rotation_vector
from labcal.report.calibration_page import calibration_page
from labcal.report.page.provenance import Provenance
from labcal.report.page_maker import PageMaker
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid

See = Callable[[Mapping[str, Camera], DotGrid, Mapping[str, np.ndarray]], Detections]
MAKER = PageMaker(Provenance("labcal calibrate", {}, {}), str)
NOISE_PX = 0.02


def noisy(dots: Detections) -> Detections:
    noise = NOISE_PX * np.random.default_rng(2).normal(size=dots.position.shape)
    return replace(dots, position=dots.position + noise)


def test_of_one_camera(
    centroids: See, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> None:
    dots = noisy(centroids({"left": pair["left"]}, grid, poses))
    text = calibration_page(calibrated(dots, grid), dots, grid, MAKER).text()
    assert "one camera gives no depth" in text
    assert "error-map" not in text  # there are no points in space


def test_of_freed_dots_the_print_is_shown(
    centroids: See, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> None:
    dots = noisy(centroids(pair, grid, poses))
    made = calibrated(dots, grid, settings=HandheldSettings(dot_places="freed"))
    text = calibration_page(made, dots, grid, MAKER).text()
    assert '<figure class="chart" id="print">' in text
    assert "print.csv" in text
    assert "errors of the print" not in text


def test_of_contradictions_the_causes_are_listed(
    centroids: See, pair: dict[str, Camera], grid: DotGrid, poses: dict[str, np.ndarray]
) -> None:
    dots = noisy(centroids(pair, grid, poses))
    after = (dots.camera == "right") & np.isin(dots.view, dots.views[4:])
    dots = replace(dots, position=dots.position + np.where(after[:, None], [6.0, 2.0], 0.0))
    text = calibration_page(calibrated(dots, grid), dots, grid, MAKER).text()
    assert "tone-bad" in text
    assert "do not believe it" in text
    assert "Likely causes of the contradiction" in text


@pytest.mark.slow
def test_of_parallel_rays(centroids: See) -> None:
    K, dist, depth = [[12.0, 0.0, 639.5], [0.0, 12.1, 479.5], [0.0, 0.0, 1.0]], np.zeros(5), 500.0
    T = from_rotation_vector(np.array([0.05, 0.5, -0.03]), np.zeros(3))
    T[:3, 3] = [0.0, 0.0, depth] - T[:3, 2] * depth
    cameras = {
        "left": Camera(K, "telecentric", dist, np.eye(4), (1280, 960)),
        "right": Camera(K, "telecentric", dist, T, (1280, 960)),
    }
    target, random, poses = load_target("rings-10x8"), np.random.default_rng(8), {}
    for number in range(8):
        turned = from_rotation_vector(random.normal(0.0, 0.3, 3), np.zeros(3))
        turned[:3, :3] = np.diag([1.0, -1.0, -1.0]) @ turned[:3, :3]
        turned[:3, 3] = [0.0, 0.0, depth] - turned[:3, :3] @ target.points().mean(axis=0)
        poses[f"pose-{number}"] = turned
    dots = noisy(centroids(cameras, target, poses))
    text = calibration_page(calibrated(dots, target, "telecentric"), dots, target, MAKER).text()
    assert "the distance does not matter" in text
    assert "an unknown length" not in text
