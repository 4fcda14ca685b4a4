"""The volume of 100 x 100 x 1000 mm: its cameras, its data, and figures with a known answer."""

import cv2
import numpy as np
import pytest

from labcal.bench.distortion.protocols.josa_volume import (
    LENGTH_MM,
    LENGTHS,
    POINTS,
    cameras,
    josa_data,
    josa_figures,
)
from labcal.bench.distortion.protocols.protocol import LOOSE, ProtocolData
from labcal.bench.families.registry import family_by_name


@pytest.fixture(scope="module")
def data() -> ProtocolData:
    return josa_data(3)


def test_both_cameras_see_all_of_the_volume_and_its_near_end_fills_a_picture() -> None:
    ends = np.stack(np.meshgrid((0.0, 100.0), (0.0, 100.0), (0.0, 1000.0)), axis=-1).reshape(-1, 3)
    for camera in cameras():
        q = camera.project(ends).q
        assert camera.in_picture(q).all()
        assert np.ptp(q[ends[:, 2] == 1000.0, 1]) > 0.7 * camera.size[1]


def test_the_lens_shifts_pixels_as_that_of_the_family_brown_does() -> None:
    offsets = np.array([[300.0, 200.0], [-250.0, 300.0], [50.0, -350.0]])  # from the principal point
    shifts = []
    for camera in (cameras()[0], family_by_name("brown").pair(0.6, 0)[0]):
        f = camera.K[0, 0]
        p = np.column_stack([offsets / f, np.ones(3)])
        q, _ = cv2.projectPoints(p, np.zeros(3), np.zeros(3), camera.K, camera.dist)
        shifts.append(q.reshape(-1, 2) - camera.K[:2, 2] - offsets)
    assert np.abs(shifts[1]).max() > 10.0
    np.testing.assert_allclose(shifts[0], shifts[1], atol=1e-9)


def test_data_are_of_the_volume_and_lengths_are_of_1000_mm(data: ProtocolData) -> None:
    assert ((data.p >= 0.0) & (data.p <= [100.0, 100.0, 1000.0])).all()
    assert (data.group == LOOSE).sum() == POINTS
    for number in range(LENGTHS):
        foot, head = data.p[data.group == number]
        assert np.linalg.norm(head - foot) == pytest.approx(LENGTH_MM)
    noise = data.X.reshape(-1, 2, 2) - np.stack([camera.project(data.Y).q for camera in cameras()], axis=1)
    assert noise.std() == pytest.approx(0.1, rel=0.1)
    assert not np.array_equal(josa_data(4).X, data.X)


def test_figures_have_known_answers(data: ProtocolData) -> None:
    assert josa_figures(data.p, data) == pytest.approx((0.0, 0.0, 0.0, 0.0, 0.0))
    shifted = data.p + np.array([0.0, 3.0, 4.0])
    assert josa_figures(shifted, data) == pytest.approx((1.0, 5.0, 5.0, 0.0, 0.0))
    longer = data.p.copy()
    longer[POINTS + LENGTHS :: 2, 2] += 2.0  # every other length
    above, greatest, _, scatter, mean = josa_figures(longer, data)
    assert (above, greatest) == (0.0, 0.0)
    assert (scatter, mean) == pytest.approx((1.0, 1.0), rel=0.01)


def test_points_that_are_not_measured_count_as_large_errors(data: ProtocolData) -> None:
    lost = data.p.copy()
    lost[: POINTS // 4] = np.nan
    assert josa_figures(lost, data)[:3] == pytest.approx((0.25, 0.0, 0.0))
    assert josa_figures(np.full_like(lost, np.nan), data)[0] == 1.0
