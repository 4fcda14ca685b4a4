"""Drawn pictures against what is known of them, and the noise that is found in them."""

import numpy as np
import pytest

from labcal import examples
from labcal.detect.detector import detect_dots
from labcal.guide.rehearsal.dot_noise import DotNoise, measured_noise
from labcal.guide.rehearsal.drawn_view import _fill, drawn_view, relative_light
from labcal.guide.rehearsal.planned_rig import PlannedRig
from labcal.render.sensor_response import Shot
from labcal.scene.photometry import Photometry


def test_a_filled_outline_has_its_area_and_its_centroid() -> None:
    random = np.random.default_rng(0)
    angle = 2.0 * np.pi * np.arange(64) / 64
    for _ in range(20):
        centre = random.uniform(20.0, 30.0, 2)
        share = np.zeros((200, 200), dtype=np.float32)
        _fill(share, 4.0 * centre + np.stack([24.0 * np.cos(angle), 16.0 * np.sin(angle)], axis=-1), 1.0)
        y, x = np.mgrid[:200, :200]
        assert share.sum() == pytest.approx(16.0 * 24.0 * np.pi, rel=2e-3)
        found = np.array([(x * share).sum(), (y * share).sum()]) / share.sum()
        np.testing.assert_allclose(found, 4.0 * centre, atol=0.04)


def test_the_detector_finds_the_dots_where_they_are_drawn() -> None:
    planned = PlannedRig.of(examples.rig_plan())
    target, camera = planned.plan.target, planned.cameras[0]
    sharp = Photometry(full_well_e=1e6, read_noise_e=0.0, adc_bits=16, format="png", bits=16)
    view = drawn_view(camera, planned.views(6, 0)[0], target, sharp, Shot(0, "one", "left"))
    dots = detect_dots(view.picture, target)
    number = dots.index[dots.ok] @ [1, target.cols]
    assert len(number) == target.count
    error = dots.position[dots.ok] + view.corner - view.images.centroid[number]
    assert np.abs(error).max() < 0.02
    assert np.abs(error.mean(axis=0)).max() < 0.002


@pytest.mark.parametrize("blur_px", [0.4, 0.8])
def test_the_lens_blurs_before_the_sensor_takes_its_samples(blur_px: float) -> None:
    # Dots that were blurred after that were off by 0.005 px.
    planned = PlannedRig.of(examples.rig_plan())
    target, camera = planned.plan.target, planned.cameras[0]
    linear = Photometry(
        blur_px=blur_px, full_well_e=1e9, read_noise_e=0.0, adc_bits=16, format="png", bits=16,
        tone_curve="linear",
    )  # fmt: skip
    off = []
    for T_world_target in planned.views(3, 0):
        view = drawn_view(camera, T_world_target, target, linear, Shot(0, "one", "left"))
        dots = detect_dots(view.picture, target)
        number = dots.index[dots.ok] @ [1, target.cols]
        off.append(dots.position[dots.ok] + view.corner - view.images.centroid[number])
    assert np.sqrt((np.concatenate(off) ** 2).sum(axis=1).mean()) < 0.002


def test_light_falls_off_as_the_sensor_says() -> None:
    camera = PlannedRig.of(examples.rig_plan()).cameras[0]
    whole = np.zeros(2, dtype=np.int64), np.array(camera.size, dtype=np.int64)
    even = relative_light(camera, Photometry(), *whole)
    assert (even == 1.0).all()
    light = relative_light(camera, Photometry(fall_off=True, vignetting=0.1), *whole)
    ray = camera.rays(np.array([0.0, 0.0])).direction
    radius2 = (319.5**2 + 239.5**2) / (320.0**2 + 240.0**2)
    assert light[0, 0] == pytest.approx(ray[2] ** 4 * (1.0 - 0.1 * radius2), rel=1e-5)


def test_noise_by_size_is_found_from_errors() -> None:
    random = np.random.default_rng(1)
    size = random.uniform(3.0, 12.0, 4000)
    true = DotNoise(6.0, 1e-4, -2.0)
    error = np.sqrt(true.at(size))[:, None] * random.standard_normal((4000, 2))
    found = DotNoise.of_errors(size, error)
    assert found.power == pytest.approx(-2.0, abs=0.15)
    np.testing.assert_allclose(found.at(np.array([4.0, 10.0])), true.at(np.array([4.0, 10.0])), rtol=0.1)
    assert found.times(0.5).variance == pytest.approx(0.25 * found.variance)


def test_pictures_without_dots_are_refused() -> None:
    with pytest.raises(ValueError, match="larger dots"):
        measured_noise([])
