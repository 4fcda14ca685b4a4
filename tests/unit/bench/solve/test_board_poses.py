"""Poses of boards in the hand: pictures that a user could take of every kind of board."""

import numpy as np
import pytest

from labcal.bench.solve.board_poses import (
    BOARDS,
    MOST_TILT_DEG,
    PAIR,
    board_poses,
    least_feature,
    narrowest_px,
    tilt_deg,
)
from labcal.geometry.poses import pose
from labcal.rng import generator
from labcal.targets.catalogue import load_target


@pytest.mark.parametrize("board", BOARDS)
def test_no_part_of_a_board_is_too_small_and_no_board_too_steep(board: str) -> None:
    target = load_target(BOARDS[board])
    p, (size_mm, least_px) = target.points(), least_feature(target)
    for T in board_poses(target, 30, generator(1, "test")):
        for camera in PAIR.cameras():
            assert tilt_deg(camera, T, p.mean(axis=0)) <= MOST_TILT_DEG
            seen = camera.in_picture(camera.project(p @ T[:3, :3].T + T[:3, 3]).q)
            inside = size_mm * narrowest_px(camera, T, p[seen])
            assert np.quantile(inside, 0.1) >= least_px


@pytest.mark.parametrize(
    ("board", "size_mm"),
    [
        ("chessboard", 20.0),
        ("marked chessboard", 18.0),
        ("charuco", 15.0 / 7.0),
        ("aprilgrid", 2.2),
        ("dots", 12.6),
    ],
)
def test_the_smallest_part_is_that_which_must_be_distinguished(board: str, size_mm: float) -> None:
    assert least_feature(load_target(BOARDS[board]))[0] == pytest.approx(size_mm)


def test_a_disc_seen_aslant_is_as_narrow_as_the_cosine_of_its_tilt() -> None:
    camera = PAIR.cameras()[0]
    tilt = np.radians(60.0)
    R = np.array([[1.0, 0.0, 0.0], [0.0, -np.cos(tilt), np.sin(tilt)], [0.0, -np.sin(tilt), -np.cos(tilt)]])
    axis = np.array([0.0, 0.0, 500.0])  # of the camera, where the lens does not distort
    T = pose(R, axis)
    assert tilt_deg(camera, T, np.zeros(3)) == pytest.approx(60.0)
    expected = camera.K[1, 1] / 500.0 * np.cos(tilt)
    assert narrowest_px(camera, T, np.zeros((1, 3)))[0] == pytest.approx(expected, rel=2e-3)
