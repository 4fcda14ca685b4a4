"""Contours of dark spots: ellipses are told from other shapes."""

import cv2
import numpy as np

from labcal.detect.outlines.contours import AREA, CENTRE, HIGH, LOW, SCATTER, SHAPE, contour_table


def _table(*contours: np.ndarray) -> np.ndarray:
    ends = np.cumsum([len(contour) for contour in contours])
    return contour_table(np.concatenate(contours).astype(np.int32), ends)


def test_an_ellipse_has_its_centre_and_its_semi_axes() -> None:
    angle = np.linspace(0.0, 2.0 * np.pi, 2000, endpoint=False)
    turn = np.array([[0.8, -0.6], [0.6, 0.8]])
    ellipse = np.array([5000.0, 3000.0]) + np.stack([900 * np.cos(angle), 400 * np.sin(angle)], -1) @ turn.T
    (row,) = _table(np.round(ellipse))
    np.testing.assert_allclose(row[CENTRE], [5000.0, 3000.0], atol=0.1)
    expected = turn @ np.diag([900.0**2, 400.0**2]) @ turn.T
    np.testing.assert_allclose(row[SHAPE], expected[[0, 0, 1], [0, 1, 1]], rtol=1e-3)
    np.testing.assert_allclose(row[AREA], np.pi * 900 * 400, rtol=1e-3)
    assert row[SCATTER] < 0.01
    np.testing.assert_array_equal(row[LOW], np.round(ellipse).min(axis=0))
    np.testing.assert_array_equal(row[HIGH], np.round(ellipse).max(axis=0))


def test_moments_are_those_of_opencv_whatever_the_turn_of_the_contour() -> None:
    triangle = np.array([[10, 10], [70, 20], [30, 90]])
    moments = cv2.moments(triangle.reshape(-1, 1, 2).astype(np.int32))
    first, second = _table(triangle, triangle[::-1])
    np.testing.assert_allclose(first, second, rtol=1e-9)
    np.testing.assert_allclose(first[AREA], moments["m00"])
    np.testing.assert_allclose(
        first[CENTRE], [moments["m10"] / moments["m00"], moments["m01"] / moments["m00"]]
    )
    central = np.array([moments["mu20"], moments["mu11"], moments["mu02"]])
    np.testing.assert_allclose(first[SHAPE], 4 * central / moments["m00"], rtol=1e-9)


def test_a_square_is_no_ellipse() -> None:
    mask = np.zeros((80, 80), np.uint8)
    mask[20:61, 20:61] = 1
    (contour,), _ = cv2.findContours(mask, cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    assert _table(contour.reshape(-1, 2))[0][SCATTER] > 0.1


def test_a_line_and_a_point_enclose_nothing() -> None:
    line, point = _table(np.array([[0, 0], [5, 0], [9, 0], [5, 0]]), np.array([[3, 4]]))
    for row in (line, point):
        assert row[AREA] == 0.0
        assert row[SCATTER] == np.inf
