"""Times of detection in comparison with OpenCV's."""

import cv2
import numpy as np
import pytest

from labcal.bench.detect.speed import SIZE, TARGET, drawn_board, fastest_of_opencv
from labcal.bench.detect.speed_boards import BOARDS, SIZES, drawn_print
from labcal.bench.detect.timing import Times, times_in_turn
from labcal.detect.detector import detect_dots
from labcal.rng import generator
from labcal.run.threads import one_opencv_thread
from labcal.targets.catalogue import load_target

MOST_OF_OPENCV = 0.75
"""Processor time over that of OpenCV's: it was 1.6, 0.8 with products in vectors, and is 0.6 now."""


def test_calls_are_taken_in_turn() -> None:
    order: list[str] = []
    first, second = times_in_turn((lambda: order.append("a"), lambda: order.append("b")), 3)
    assert order == ["a", "b"] * 3
    assert first.cpu.shape == second.wall.shape == (3,)


def test_the_ratio_is_of_the_least_times() -> None:
    one, other = Times(np.array([3.0, 1.0]), np.ones(2)), Times(np.array([2.0, 9.0]), np.ones(2))
    assert one.over(other) == 0.5


def test_opencv_has_its_threads_again_afterwards() -> None:
    before = cv2.getNumThreads()
    with one_opencv_thread():
        assert cv2.getNumThreads() == 1
    assert cv2.getNumThreads() == before


@pytest.mark.parametrize("name", BOARDS)
def test_the_drawn_print_of_a_board_is_on_paper_before_a_room(name: str) -> None:
    picture = drawn_print(load_target(name), SIZES[0], generator(0, "test"))
    assert picture.shape == SIZES[0][::-1]
    assert abs(float(np.median(picture[:5])) - 100.0) < 2.0
    dark, light = (picture < 70).mean(), (picture > 180).mean()
    assert 0.1 < dark < 0.5
    assert 0.1 < light < 0.5


@pytest.mark.slow
def test_dots_take_no_longer_than_find_circles_grid() -> None:
    random = generator(0, "test", "speed")
    picture, plain = drawn_board(SIZE, random), drawn_board(SIZE, random, hole=0.0)
    detect_dots(picture, TARGET)  # compiled by now
    with one_opencv_thread():
        fastest = fastest_of_opencv((picture, plain))
        own, other = times_in_turn((lambda: detect_dots(picture, TARGET), fastest), 15)
    assert own.over(other) < MOST_OF_OPENCV
