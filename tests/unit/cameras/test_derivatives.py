"""Derivatives of all lenses in one pass, against OpenCV's and against differences."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from labcal.cameras.camera import Camera
from labcal.cameras.derivatives import point_derivatives, projection_derivatives
from labcal.geometry.poses import transform


def test_they_are_opencvs(camera: Camera, points: np.ndarray) -> None:
    if camera.lens == "fisheye-kb4":
        pytest.skip("OpenCV's fisheye orders its derivatives otherwise; the differences below cover it")
    if camera.model.opencv is None:
        pytest.skip("none of OpenCV's lenses; the differences below cover it")
    p = transform(camera.T_cam_world, points)
    dist = camera.dist[: max(camera.model.coefficients, 4)]
    q, J = cv2.projectPoints(p, np.zeros(3), np.zeros(3), camera.K, dist)
    found = projection_derivatives(camera, p)
    assert found.ok.all()
    np.testing.assert_allclose(found.q, q[:, 0], atol=1e-8)
    J = J.reshape(-1, 2, J.shape[1])
    free = camera.model.coefficients
    np.testing.assert_allclose(found.by_point, J[:, :, 3:6], rtol=1e-6, atol=1e-8)
    np.testing.assert_allclose(found.by_camera, J[:, :, 6 : 10 + free], rtol=1e-6, atol=1e-6)


def test_they_are_the_slopes_of_the_projection(camera: Camera, points: np.ndarray) -> None:
    p = transform(camera.T_cam_world, points)
    found = projection_derivatives(camera, p)
    at_origin = replace(camera, T_cam_world=np.eye(4))
    np.testing.assert_allclose(found.q, at_origin.project(p).q, atol=1e-9)
    alone = point_derivatives(camera, p)
    np.testing.assert_allclose(alone.q, found.q, atol=1e-9)
    np.testing.assert_allclose(alone.by_point, found.by_point, rtol=1e-9, atol=1e-12)
    assert alone.by_camera.shape == (len(p), 2, 0)
    for number in range(camera.model.coefficients):
        step = np.zeros(len(camera.dist))
        step[number] = 1e-6
        ahead = replace(at_origin, dist=camera.dist + step).project(p).q
        behind = replace(at_origin, dist=camera.dist - step).project(p).q
        slope = (ahead - behind) / 2e-6
        np.testing.assert_allclose(found.by_camera[:, :, 4 + number], slope, rtol=1e-5, atol=2e-3)


def test_points_behind_are_not_ok() -> None:
    K = np.array([[700.0, 0.0, 320.0], [0.0, 700.0, 240.0], [0.0, 0.0, 1.0]])
    camera = Camera(K, "brown5", np.zeros(5), np.eye(4), (640, 480))
    found = projection_derivatives(camera, np.array([[0.0, 0.0, 500.0], [0.0, 0.0, -500.0]]))
    assert found.ok.tolist() == [True, False]
