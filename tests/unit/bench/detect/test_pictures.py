"""One small picture of the suite, from its design to the verdict, and its light."""

from dataclasses import replace

import numpy as np
import pytest

from labcal.bench.detect.design import PictureDesign, designs
from labcal.bench.detect.dot_visibility import dot_visibility
from labcal.bench.detect.exposure import blur_px, exposed_picture, falling_light
from labcal.bench.detect.suite import suite_pictures
from labcal.bench.detect.suite_scene import suite_scene
from labcal.bench.detect.verdict import verdict_of
from labcal.bench.held_board import BARE_BOARD, board_scene, still_take, tilted_pose
from labcal.detect.detector import detect_dots
from labcal.scene.camera import CameraDescription
from labcal.scene.occluders import Box, Frame


@pytest.fixture(scope="module")
def design() -> PictureDesign:
    small = next(one for one in designs(48, 0) if one.size == (640, 480) and one.tilt_deg < 45)
    return replace(small, jpeg_quality=None, bayer=False, linear=True, noise=0.02, gradient=4.0)


def test_the_board_is_as_designed(design: PictureDesign) -> None:
    stage = suite_scene(design, 0)
    seen = dot_visibility(stage.scene, stage.take, 1.5)
    T = stage.take.track.T_world_target
    assert np.degrees(np.arccos(T[2, 2])) == pytest.approx(design.tilt_deg)
    middle = np.argmin(np.linalg.norm(seen.index - seen.index.mean(axis=0), axis=1))
    minor = design.radius_px * np.sqrt(np.cos(np.radians(design.tilt_deg)))
    assert seen.minor_px[middle] == pytest.approx(minor, rel=0.25)  # the camera looks from near by


def test_what_lies_over_half_a_dot_hides_half_of_it(design: PictureDesign) -> None:
    target = suite_scene(replace(design, hidden=0.0), 0).scene.target
    pitch, eye = target.pitch_x_mm, (0.0, 0.0, 4000.0)
    camera = CameraDescription(
        size=(640, 480), focal_px=2000.0, lens="pinhole", eye_mm=eye, look_at_mm=(0.0, 0.0, 0.0)
    )
    # From beyond the left edge to the middles of the third column; thin, and close to the print.
    box = Box(
        kind="box",
        frame=Frame.TARGET,
        centre_mm=(2.0 * pitch - 500.0, 0.0, 0.1),
        size_mm=(1000.0, 9000.0, 0.02),
    )
    scene = board_scene(target, camera, 1, (box,))
    seen = dot_visibility(scene, still_take(scene, tilted_pose(target, 0.0, 0.0, 0.0, np.zeros(3))), 0.5)
    by_column = [seen.hidden[seen.index[:, 0] == col] for col in range(4)]
    np.testing.assert_allclose(np.concatenate(by_column[:2]), 1.0)
    np.testing.assert_allclose(by_column[2], 0.5, atol=0.04)
    np.testing.assert_allclose(by_column[3], 0.0)
    assert not seen.measurable[seen.index[:, 0] <= 2].any()
    assert seen.measurable[(seen.index[:, 0] == 3) & seen.in_frame].all()


def test_light_falls_and_noise_is_as_designed(design: PictureDesign) -> None:
    stage = suite_scene(design, 0)
    seen = dot_visibility(stage.scene, stage.take, 1.5)
    q = np.stack(np.meshgrid(np.arange(640.0), np.arange(480.0)), axis=-1)
    light = (BARE_BOARD * falling_light(design, seen)(q)).astype(np.float32)
    many = np.stack([exposed_picture(light, design, seed).astype(float) for seed in range(40)])
    mean = many.mean(axis=0)
    assert mean.max() == pytest.approx(0.8 * 255, rel=0.02)
    assert mean.max() / mean.min() == pytest.approx(4.0, rel=0.1)
    bright = mean > 0.95 * mean.max()
    measured = many.std(axis=0, ddof=1)[bright].mean() / 255
    assert measured == pytest.approx(design.noise, rel=0.05)


def test_blur_does_not_drown_the_smallest_dot(design: PictureDesign) -> None:
    least = replace(design, blur=0.0)
    most = replace(design, blur=1.0)
    minor = np.array([2.0, 4.0, 30.0])
    assert blur_px(least, minor) == pytest.approx(0.35)
    assert blur_px(most, minor) == pytest.approx(0.35 * 4.0)


def test_a_picture_of_the_suite_is_judged_by_its_truth() -> None:
    names = [one.name for one in designs(48, 0) if one.size == (640, 480) and one.tilt_deg < 30]
    (one,) = suite_pictures(48, 0, frozenset(names[:1]))
    (again,) = suite_pictures(48, 0, frozenset(names[:1]))
    np.testing.assert_array_equal(one.picture, again.picture)
    verdict = verdict_of(detect_dots(one.picture, one.target), one.seen, one.target.cols)
    assert verdict.indexed
    assert (verdict.wrong_ids, verdict.false_dots) == (0, 0)
    assert verdict.found >= 0.9 * verdict.measurable > 0
    # A truth that is half a pitch off makes every id wrong.
    moved = replace(one.seen, centroid=one.seen.centroid + 0.6 * one.seen.pitch_px[:, None])
    assert verdict_of(detect_dots(one.picture, one.target), moved, one.target.cols).found == 0
