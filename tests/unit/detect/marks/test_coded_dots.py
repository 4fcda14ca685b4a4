"""Coded dots on drawn pictures whose truth is exact."""

import numpy as np
import pytest

from labcal.bench.marks.coded_dots import coded_outcome
from labcal.bench.marks.coded_picture import CodedPicture, coded_picture
from labcal.bench.marks.drawn_picture import Cover, Exposure, drawn, tilted
from labcal.detect.grey import grey_picture
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.detect.marks.picture_marks import MarkFlag
from labcal.detect.marks.round_dots import round_spots, sharp_spots
from labcal.detect.settings import DEFAULTS
from labcal.targets.coded_dots import RING_INNER, RING_OUTER
from labcal.targets.ring_codes import RingCode, code_book

CODE = RingCode.RING_23
SIZE = (260, 200)


def one_mark(
    word: np.ndarray, tilt: float = 40.0, radius: float = 9.0, turn: float = 0.3, blur: float = 0.8
) -> np.ndarray:
    """Draw one mark whose sectors are a word's, black where it is true."""

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        rho = np.hypot(x, y)
        sector = np.floor((turn - np.arctan2(y, x) / (2 * np.pi)) * len(word)).astype(int) % len(word)
        ring = (rho > RING_INNER) & (rho < RING_OUTER) & word[sector]
        return np.where((rho < 1.0) | ring, 1.0, 0.0)

    H = tilted(np.radians(tilt), 0.4, 0.0, 600.0 / radius, 600.0)
    H = np.array([[1.0, 0.0, 131.2], [0.0, 1.0, 99.7], [0.0, 0.0, 1.0]]) @ H
    exposure = Exposure(SIZE, H, blur, np.array([0.002, -0.001]), 0.01)
    return drawn(exposure, ink, (), np.random.default_rng(5))


@pytest.fixture(scope="module")
def pictures() -> list[CodedPicture]:
    return [coded_picture(CODE, number, 0) for number in range(4)]


def test_marks_in_sight_are_read_none_wrongly_and_stated_sigmas_hold(pictures: list[CodedPicture]) -> None:
    outcomes = [coded_outcome(one, find_coded_dots(one.picture, CODE)) for one in pictures]
    found, hidden = (np.concatenate([getattr(one, name) for one in outcomes]) for name in ("found", "hidden"))
    assert len(found) > 10
    assert found[hidden == 0.0].all()
    assert sum(one.wrong for one in outcomes) == 0
    error = np.concatenate([one.error for one in outcomes])
    covariance = np.concatenate([one.covariance for one in outcomes])
    squares = float(np.einsum("ni,nij,nj->", error, np.linalg.inv(covariance), error))
    freedom = 2 * len(error)
    assert abs(squares - freedom) < 4.0 * np.sqrt(2.0 * freedom)


@pytest.mark.parametrize("mark", [0, 57, 111])
def test_the_name_is_that_of_the_word_however_it_is_turned(mark: int) -> None:
    word = code_book(CODE).word(mark)
    for turn in (0.0, 0.31, 0.77):
        marks = find_coded_dots(one_mark(word, turn=turn), CODE)
        assert [name for name, ok in zip(marks.point, marks.ok, strict=True) if ok] == [f"ring-23-{mark}"]


def test_wrong_sectors_are_borne_side_by_side_and_not_in_two_places() -> None:
    right = code_book(CODE).word(57)
    for sectors, borne in (((3,), True), ((3, 4), True), ((3, 8), False), ((3, 8, 14), False)):
        word = right.copy()
        word[list(sectors)] = ~word[list(sectors)]
        marks = find_coded_dots(one_mark(word), CODE)
        assert [name for name, ok in zip(marks.point, marks.ok, strict=True) if ok] == ["ring-23-57"] * borne
        assert borne or MarkFlag.UNKNOWN_CODE in marks.flag or MarkFlag.AMBIGUOUS in marks.flag


@pytest.mark.parametrize("mark", [17, 88])
def test_a_ring_that_is_as_soft_as_a_third_of_its_dot_is_read(mark: int) -> None:
    picture = one_mark(code_book(CODE).word(mark), 10.0, 6.2, blur=2.15)
    marks = find_coded_dots(picture, CODE)
    assert [name for name, ok in zip(marks.point, marks.ok, strict=True) if ok] == [f"ring-23-{mark}"]


def test_sharp_spots_have_the_blur_and_the_size_of_the_print() -> None:
    grey = grey_picture(one_mark(code_book(CODE).word(17), 0.0, 6.2, blur=2.15))
    rough = round_spots(grey, DEFAULTS, DEFAULTS.mark.max_texture_share)
    rough = rough.select(np.linalg.norm(rough.centre - [131.2, 99.7], axis=1) < 1.0)
    sharp = sharp_spots(grey, rough, DEFAULTS)
    seen = np.hypot(2.15, 12.0**-0.5)
    assert rough.blur[0] < 0.75 * seen
    assert sharp.blur[0] == pytest.approx(seen, rel=0.1)
    assert sharp.radius[0] == pytest.approx(6.2, rel=0.03)
    assert len(sharp_spots(grey, rough.select(np.zeros(1, dtype=bool)), DEFAULTS).centre) == 0


def covered(level: float, share: float, mark: int) -> np.ndarray:
    """Return a picture of one mark with a share of its ring under a sheet of a grey value."""
    word, rim = code_book(CODE).word(mark), 0.5 * (RING_INNER + RING_OUTER)

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        rho = np.hypot(x, y)
        sector = np.floor((0.4 - np.arctan2(y, x) / (2 * np.pi)) * len(word)).astype(int) % len(word)
        return np.where((rho < 1.0) | ((rho > RING_INNER) & (rho < RING_OUTER) & word[sector]), 1.0, 0.0)

    exposure = Exposure((130, 120), np.array([[9.0, 0, 64.2], [0, -9.0, 59.7], [0, 0, 1]]), 0.9,
                        np.array([0.002, -0.001]), 0.015)  # fmt: skip
    edge = 9.0 * rim * np.cos(np.pi * share)
    cover = Cover(np.array([64.2 + edge + 60.0, 59.7]), np.array([60.0, 200.0]), 0.0, level)
    return drawn(exposure, ink, (cover,), np.random.default_rng(mark))


@pytest.mark.parametrize("level", [0.0, 0.25, 0.5, 0.95])
@pytest.mark.parametrize("mark", [4, 61, 95])
def test_a_ring_that_is_covered_by_a_third_is_read(level: float, mark: int) -> None:
    found = find_coded_dots(covered(level, 0.3, mark), CODE)
    assert [name for name, ok in zip(found.point, found.ok, strict=True) if ok] == [f"ring-23-{mark}"]


@pytest.mark.parametrize("level", [0.0, 0.5, 0.95])
def test_a_ring_that_is_covered_by_a_half_has_no_name(level: float) -> None:
    assert not find_coded_dots(covered(level, 0.5, 61), CODE).ok.any()


def test_plain_dots_and_whole_rings_are_no_marks_at_all() -> None:
    for black in (False, True):
        assert len(find_coded_dots(one_mark(np.full(23, black)), CODE).point) == 0


def test_a_name_that_is_seen_twice_is_measured_nowhere() -> None:
    picture = one_mark(code_book(CODE).word(5))
    marks = find_coded_dots(np.concatenate([picture, picture], axis=1), CODE)
    assert marks.point[:2] == ("ring-23-5", "ring-23-5")
    assert marks.flag[:2] == (MarkFlag.REPEATED, MarkFlag.REPEATED)
    assert np.isnan(marks.position).all()


def test_strong_perspective_is_undone() -> None:
    word = code_book(CODE).word(33)
    H = tilted(np.radians(55.0), 1.1, 0.0, 9.0, 250.0)
    H = np.array([[1.0, 0.0, 131.2], [0.0, 1.0, 99.7], [0.0, 0.0, 1.0]]) @ H

    def ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
        rho = np.hypot(x, y)
        sector = np.floor(-np.arctan2(y, x) / (2 * np.pi) * 23).astype(int) % 23
        return np.where((rho < 1.0) | ((rho > RING_INNER) & (rho < RING_OUTER) & word[sector]), 1.0, 0.0)

    picture = drawn(Exposure(SIZE, H, 0.8, np.zeros(2), 0.01), ink, (), np.random.default_rng(2))
    assert find_coded_dots(picture, CODE).point[0] == "ring-23-33"


@pytest.mark.parametrize("picture", [np.zeros((0, 0), np.uint8), np.full((60, 80), 7, np.uint8)])
def test_a_picture_of_nothing_holds_no_marks(picture: np.ndarray) -> None:
    assert find_coded_dots(picture, CODE).point == ()


def test_noise_holds_no_marks() -> None:
    noise = np.random.default_rng(3).integers(0, 256, (200, 300)).astype(np.uint8)
    assert not find_coded_dots(noise, CODE).ok.any()
