"""The depth sweep on ChArUco pictures: pictures, corners and figures, against OpenCV and known answers."""

from collections.abc import Callable

import cv2
import numpy as np
import pytest

from labcal.bench.distortion.protocols.charuco_pictures import PixelRays, board_picture
from labcal.bench.distortion.protocols.protocol import Protocol, ProtocolData
from labcal.bench.distortion.protocols.smooth_corners import smooth_corners
from labcal.bench.distortion.protocols.z_travel import (
    BASELINE_MM,
    BOARD,
    PICTURES,
    REFINED_Z_TRAVEL,
    Z_MM,
    Z_TRAVEL,
    cameras,
    detected_corners,
    refined_z_travel_data,
    z_travel_data,
    z_travel_figures,
)
from labcal.cameras.camera import Camera


@pytest.fixture(scope="module")
def pictures() -> list[np.ndarray]:
    random = np.random.default_rng(4)
    return [board_picture(PixelRays.of(camera), BOARD, Z_MM[4], PICTURES, random) for camera in cameras()]


def seen(camera: Camera, p: np.ndarray, x: float) -> np.ndarray:
    """Project world points by OpenCV into a camera that stands at x."""
    q, _ = cv2.projectPoints(p, np.zeros(3), np.array([-x, 0.0, 0.0]), camera.K, camera.dist)
    return q.reshape(-1, 2)


def centred(index: np.ndarray, z: float) -> np.ndarray:
    """World places of (col, row), in squares, right and down from the upper left corner of the board."""
    across = (index - 0.5 * np.array(BOARD.squares)) * BOARD.square_mm
    return np.column_stack([across, np.full(len(index), z)])


def test_black_squares_are_dark_and_the_frame_of_markers_is_light(pictures: list[np.ndarray]) -> None:
    at = np.array([(col, row) for col in range(14) for row in range(8)])
    black = (at.sum(axis=1) % 2) == 0
    for camera, picture, x in zip(cameras(), pictures, (0.0, BASELINE_MM), strict=True):
        for inset, is_dark in ((0.5, black), (0.08, black)):
            some = is_dark if inset == 0.5 else np.ones(len(at), dtype=bool)
            q = np.rint(seen(camera, centred(at[some] + inset, Z_MM[4]), x)).astype(int)
            grey = picture[q[:, 1], q[:, 0]]
            dark = is_dark[some]
            assert grey[dark].max() < 60
            assert inset == 0.5 or grey[~dark].min() > 150


def test_corners_are_detected_where_opencv_projects_them(pictures: list[np.ndarray]) -> None:
    at = np.array([(col + 1, 7 - row) for row in range(7) for col in range(13)])  # in the order of `points`
    for camera, picture, x in zip(cameras(), pictures, (0.0, BASELINE_MM), strict=True):
        q, _ = detected_corners(picture)
        error = q - seen(camera, centred(at, Z_MM[4]), x)
        assert np.isfinite(error).all()
        assert np.abs(error.mean(axis=0)).max() < 0.1
        assert np.sqrt((error**2).mean()) < 0.3


def test_figures_have_known_answers() -> None:
    p = np.tile([0.1, 0.2, 3.0], (12, 1))
    group = np.repeat([0, 1, 2], 4)
    empty = np.zeros((12, 2, 2))
    data = ProtocolData(
        np.zeros((1, 4)), p[:1], ((800, 600),) * 2, empty, np.zeros((12, 2, 2, 2)), p, group, p
    )
    assert z_travel_figures(p, data) == pytest.approx((0.0, 0.0, 0.0, 0.0))
    measured = p + np.array([0.002, -0.001, 0.003])  # the same everywhere: no error of travel
    assert z_travel_figures(measured, data) == pytest.approx((3.0, 2.0, 1.0, 0.0))
    measured[group == 2, 2] += 0.004
    measured[0] = np.nan
    lost = np.where(group[:, None] == 1, np.nan, measured)
    assert z_travel_figures(lost, data)[3] == pytest.approx(4.0)
    assert z_travel_figures(measured, data)[3] == pytest.approx(np.sqrt(0.5) * 4.0)


def test_smooth_corners_err_less_and_follow_what_is_smooth() -> None:
    camera, random = cameras()[0], np.random.default_rng(5)
    at = np.array([(col + 1, 7 - row) for row in range(7) for col in range(13)])
    exact = seen(camera, centred(at, Z_MM[4]), 0.0)
    bias = smooth_corners(BOARD.points(), exact) - exact  # a smoothing spline flattens distortion a little
    assert np.sqrt((bias**2).mean()) < 0.06
    noisy = exact + 0.2 * random.standard_normal(exact.shape)
    noisy[7] = np.nan
    smoothed = smooth_corners(BOARD.points(), noisy)
    known = np.isfinite(noisy).all(axis=1)
    np.testing.assert_array_equal(np.isfinite(smoothed).all(axis=1), known)
    assert np.sqrt(((smoothed - exact)[known] ** 2).mean()) < 0.1


@pytest.mark.slow
@pytest.mark.parametrize(
    ("data", "protocol"), [(z_travel_data, Z_TRAVEL), (refined_z_travel_data, REFINED_Z_TRAVEL)]
)
def test_exact_cameras_err_as_the_better_published_methods_do(
    data: Callable[[int], ProtocolData], protocol: Protocol
) -> None:
    depths = [one.value for one in protocol.published if one.quantity == "RMS error of Z"]
    made = data(0)
    assert len(np.unique(made.group)) == len(Z_MM)
    assert 0.7 * min(depths) < z_travel_figures(made.oracle, made)[0] < 1.3 * np.median(depths)
