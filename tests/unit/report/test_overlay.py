"""The overlay: what is drawn, and that nothing breaks it."""

import numpy as np

from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag
from labcal.report.overlay import draw_overlay
from labcal.targets.catalogue import load_target
from labcal.targets.grid import Polarity

TARGET = load_target("paper-13x10")


def test_colours_tell_the_flags() -> None:
    picture = np.full((200, 300), 100, np.uint8)
    picture[0, 0], picture[0, 1] = 0, 255
    dots = PictureDots(
        size=(300, 200),
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=None,
        index=np.array([[2, 2], [3, 2], [0, 0]]),
        has_id=np.array([True, True, False]),
        position=np.array([[60.0, 100.0], [np.nan, np.nan], [np.nan, np.nan]]),
        covariance=np.full((3, 2, 2), np.nan),
        misfit=np.ones(3),
        flag=(DotFlag.OK, DotFlag.BAD_FIT, DotFlag.NO_ID),
        seen_at=np.array([[60.0, 100.0], [150.0, 100.0], [240.0, 100.0]]),
        outline=np.tile(np.eye(2) * 400.0, (3, 1, 1)),
    )
    canvas = draw_overlay(picture, dots, TARGET)
    assert canvas.shape == (200, 300, 3)
    right_of = [canvas[100, x + 20].astype(int) for x in (60, 150, 240)]
    assert right_of[0][1] > right_of[0][0]  # green
    assert right_of[1][0] > 2 * right_of[1][1]  # red
    assert right_of[2][2] > 2 * right_of[2][1]  # pink
    assert (canvas[190, 10] == 100).all()


def test_refused_and_tiny_pictures_are_drawn() -> None:
    for shape in ((1, 1), (60, 80)):
        picture = np.zeros(shape, np.float32)
        assert draw_overlay(picture, detect_dots(picture, TARGET), TARGET).shape == (*shape, 3)


def test_the_axes_of_a_target_without_rings_run_along_its_edges() -> None:
    target = load_target("charuco-12x9")
    index = np.array([[0, 0], [10, 0], [0, 7]])
    places = np.array([[50.0, 150.0], [250.0, 150.0], [50.0, 50.0]])
    dots = PictureDots(
        size=(300, 200),
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=None,
        index=index,
        has_id=np.ones(3, dtype=bool),
        position=places,
        covariance=np.tile(np.eye(2), (3, 1, 1)),
        misfit=np.ones(3),
        flag=(DotFlag.OK,) * 3,
        seen_at=places,
        outline=np.full((3, 2, 2), np.nan),
    )
    canvas = draw_overlay(np.full((200, 300), 100, np.uint8), dots, target).astype(int)
    along_x, along_y = canvas[150, 150], canvas[100, 50]
    assert along_x[0] > 2 * along_x[2]  # red
    assert min(along_y[:2]) > 2 * along_y[2]  # yellow
