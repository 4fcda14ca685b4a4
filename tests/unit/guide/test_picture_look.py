"""Tests of exposure and sharpness where the target is, without the detector."""

from dataclasses import replace

import cv2
import numpy as np
import pytest

from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal
from labcal.guide.picture_blur import LEAST_PX, usual_edges
from labcal.guide.picture_look import PictureLook, look_at
from labcal.targets.grid import Polarity

_SIZE = (320, 240)
_CENTRES = np.array([[x, y] for y in range(60, 200, 40) for x in range(60, 280, 40)], dtype=np.float64)


def _picture(paper: float, blur_px: float, motion: int = 0) -> np.ndarray:
    picture = np.full(_SIZE[::-1], 0.3)
    cv2.rectangle(picture, (30, 30), (290, 210), paper, -1)
    for x, y in _CENTRES.astype(int).tolist():
        cv2.circle(picture, (x, y), 11, 0.1 * paper, -1, cv2.LINE_8)
    picture = cv2.GaussianBlur(picture, (0, 0), blur_px)
    if motion:
        picture = cv2.filter2D(picture, -1, np.full((1, motion), 1.0 / motion))
    picture += np.random.default_rng(1).normal(scale=0.004, size=picture.shape)
    return np.asarray(np.clip(np.rint(255.0 * picture), 0, 255).astype(np.uint8))


def _dots(refusal: Refusal | None = None) -> PictureDots:
    n = len(_CENTRES)
    return PictureDots(
        size=_SIZE,
        polarity=Polarity.BLACK_ON_WHITE,
        refusal=refusal,
        index=np.zeros((n, 2), dtype=np.int64),
        has_id=np.ones(n, dtype=bool),
        position=_CENTRES,
        covariance=np.tile(1e-4 * np.eye(2), (n, 1, 1)),
        misfit=np.ones(n),
        flag=(DotFlag.OK,) * n,
        seen_at=_CENTRES,
        outline=np.tile(121.0 * np.eye(2), (n, 1, 1)),
    )


def _look(paper: float = 0.8, blur_px: float = 0.8, motion: int = 0) -> PictureLook:
    return look_at(_picture(paper, blur_px, motion), _dots())


def test_a_good_picture_has_no_fault() -> None:
    look = _look()
    assert look.exposure_words is None
    assert look.motion_deg is None
    assert look.sigma_px == pytest.approx(0.01)
    assert look.edge_width_px < LEAST_PX


def test_burnt_out_and_dark_pictures_are_told_apart() -> None:
    burnt, dark = _look(1.2), _look(0.2)
    assert burnt.burnt
    assert "burnt out" in str(burnt.exposure_words)
    assert dark.dark
    assert not dark.burnt
    assert "too dark" in str(dark.exposure_words)


def test_a_refused_picture_of_good_light_is_not_called_dark() -> None:
    look = look_at(_picture(0.8, 0.8), _dots(Refusal.NO_RINGS))
    assert look.exposure_words is None


def test_a_blurred_picture_is_found_beside_sharp_ones_and_motion_has_a_direction() -> None:
    sharp = [_look(0.8, blur) for blur in (0.7, 0.8, 0.9)]
    soft, moved = _look(0.8, 3.0), _look(0.8, 0.8, motion=9)
    usual = usual_edges({"left": [*sharp, soft, moved]})["left"]
    assert [usual.is_blurred(one) for one in (*sharp, soft, moved)] == [False, False, False, True, True]
    assert soft.motion_deg is None
    assert moved.motion_deg == 0.0


def test_a_camera_that_is_blurred_throughout_is_found_beside_the_other() -> None:
    sharp, soft = [_look()] * 3, [_look(0.8, 3.0)] * 3
    usual = usual_edges({"left": sharp, "right": soft})
    assert usual["right"].is_blurred(soft[0])
    assert not usual["left"].is_blurred(sharp[0])


def test_a_camera_with_edges_a_little_wider_throughout_is_held_against_the_sharper_one() -> None:
    sharp, soft = [_look()] * 3, [_look(0.8, 1.7)] * 3
    usual = usual_edges({"left": sharp, "right": soft})
    assert usual["right"].is_blurred(soft[0])
    assert usual["right"].width_px < soft[0].widest_px


def test_dim_paper_is_dark_at_any_contrast_and_a_refused_picture_of_a_grey_wall_is_not() -> None:
    assert replace(_look(), paper=0.4, ink=0.05).dark
    assert not replace(_look(), paper=0.6, ink=0.05).dark
    assert not replace(_look(), paper=0.51, ink=0.5, refusal=Refusal.TOO_FEW_DOTS).dark


def test_cameras_of_one_picture_size_are_held_against_each_other_more_closely() -> None:
    sharp, soft = [_look()] * 3, [_look(0.8, 3.0)] * 3
    of_another_kind = [replace(one, size=(640, 480)) for one in soft]
    alike = usual_edges({"left": sharp, "right": soft})["right"]
    other = usual_edges({"left": sharp, "right": of_another_kind})["right"]
    assert alike.limit_px < other.limit_px


def test_a_motion_in_all_pictures_is_found_by_its_direction() -> None:
    moved = [_look(motion=9)] * 3
    assert usual_edges({"left": moved, "right": moved})["left"].is_blurred(moved[0])


def test_a_dark_picture_without_a_target_is_not_said_to_show_paper_and_ink() -> None:
    empty = replace(_look(), paper=0.04, ink=0.0, refusal=Refusal.NO_DOTS)
    assert str(empty.exposure_words).startswith("dark all over")


def test_directions_count_without_a_target_only_where_there_are_edges_of_all() -> None:
    sharp = _look()
    edge_on = replace(
        sharp,
        refusal=Refusal.TOO_FEW_DOTS,
        directions_px=np.array([1.0, np.nan, 7.8, 2.4]),
        edge_width_px=2.6,
    )
    usual = usual_edges({"left": [sharp] * 9 + [edge_on]})["left"]
    assert not usual.is_blurred(edge_on)
    assert usual.is_blurred(replace(edge_on, refusal=None))
    assert usual.is_blurred(replace(edge_on, edge_width_px=7.8))
    blurred = replace(edge_on, directions_px=np.array([2.5, 2.6, 7.8, 2.6]))
    assert usual.is_blurred(blurred)
