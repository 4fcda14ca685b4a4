"""Residuals of reconstructed points in the pictures: noise by a good rig, a pattern by one that is off."""

import numpy as np
import pytest

from labcal import Rig, examples, load_target, pipeline
from labcal.cameras.camera import Camera
from labcal.evaluate.reprojection import reprojected


def test_a_good_rig_leaves_noise() -> None:
    target, dots = load_target(examples.TARGET), examples.detections()
    found = reprojected(examples.rig(), examples.points(), dots, target)
    assert [one.camera for one in found] == ["left", "right"]
    assert all(one.q.shape == (704, 2) and one.size == (640, 480) for one in found)
    square = np.mean([(one.residual**2).sum(axis=1).mean() for one in found])
    # Of 2 x 2 components three are taken by the point: a quarter of the noise is left.
    assert np.sqrt(square) == pytest.approx(examples.SIGMA_PX / np.sqrt(2), rel=0.06)


def test_a_camera_that_is_turned_shows_a_pattern() -> None:
    target, dots, rig = load_target(examples.TARGET), examples.detections(), examples.rig()
    right = rig.camera("right")
    turned = right.T_cam_world.copy()
    turned[:3, :3] = np.array([[1, 0, 0], [0, 1, -1e-3], [0, 1e-3, 1]]) @ turned[:3, :3]
    moved = Camera(right.K, right.lens, right.dist, turned, right.size)
    off = Rig.of({"left": rig.camera("left"), "right": moved})
    points = pipeline.reconstruct(off, dots, target).points
    left, right_ = reprojected(off, points, dots, target)
    # A turn of 1 mrad about x moves the picture by 0.8 px in y, which the cameras share with opposite signs.
    assert left.residual[:, 1].mean() * right_.residual[:, 1].mean() < 0
    assert abs(right_.residual[:, 1].mean()) == pytest.approx(0.4, rel=0.2)


def test_of_other_dots_there_is_nothing() -> None:
    target, dots = load_target(examples.TARGET), examples.detections()
    few = dots.where(dots.view == dots.views[0])
    points = examples.points()
    assert reprojected(examples.rig(), points.where(points.view != dots.views[0]), few, target) == []
