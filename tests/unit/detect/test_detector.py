"""Detection on drawn boards with known truth: ids, positions, flags, refusals."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import cv2
import numpy as np
import pytest

from labcal.detect import detector
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import DotFlag, Refusal, advice
from labcal.errors import InputError, InputTypeError
from labcal.targets.catalogue import load_target
from labcal.targets.grid import DotGrid, Polarity

TARGET = load_target("paper-13x10")
WHOLE = {"focal": 700.0, "distance": 1300.0, "size": (640, 480), "noise": 1.0}
MakeBoard = Callable[..., Any]


def as_bytes(picture: np.ndarray) -> np.ndarray:
    return np.clip(np.round(picture), 0, 255).astype(np.uint8)


def check(
    board: Any,  # noqa: ANN401 - a class of conftest.py, which cannot be imported
    dots: PictureDots,
    limit: float,
) -> int:
    """Assert that ids, positions and flags are right; return the number of ok dots."""
    assert dots.refusal is None, dots.refusal
    indices = [tuple(i) for i in dots.index[dots.has_id].tolist()]
    assert len(set(indices)) == len(indices)
    for stray in dots.seen_at[~dots.has_id]:  # nothing is told twice
        assert np.linalg.norm(dots.seen_at[dots.has_id] - stray, axis=1).min() > 3.0
    for index, position, seen, flag in zip(
        dots.index[dots.has_id].tolist(), dots.position, dots.seen_at, dots.flag, strict=False
    ):
        outline = board.outline(tuple(index))
        whole = (outline > 0).all() and (outline < np.array(board.size) - 1).all()
        assert np.linalg.norm(seen - board.centroid(tuple(index))) < np.ptp(outline, axis=0).max() / 2 + 1
        if flag in (DotFlag.OK, DotFlag.BEYOND_GRID):
            assert np.abs(position - board.centroid(tuple(index))).max() < limit, (index, position)
            declared = 0 <= index[0] < board.target.cols and 0 <= index[1] < board.target.rows
            assert (flag is DotFlag.OK) == declared
        else:
            assert np.isnan(position).all()
        if flag is DotFlag.CUT:
            assert not whole
    return int(dots.ok.sum())


@pytest.mark.parametrize("turn", [0, 90, 180, 270, 37])
def test_every_dot_has_its_id_at_any_turn(make_board: MakeBoard, turn: float) -> None:
    board = make_board(TARGET, rotation=(20, -15, turn), **WHOLE | {"size": (560, 560), "distance": 1500.0})
    assert check(board, detect_dots(as_bytes(board.draw()), TARGET), 0.06) == 130


def test_equal_legs_still_give_one_orientation(make_board: MakeBoard) -> None:
    content = TARGET.model_dump() | {
        "pitch_y_mm": TARGET.pitch_x_mm,
        "rings": {"origin": (2, 2), "x": (6, 2), "y": (2, 6)},
    }
    square = DotGrid.model_validate(content)
    board = make_board(square, rotation=(10, 20, 190), **WHOLE | {"size": (560, 560)})
    assert check(board, detect_dots(as_bytes(board.draw()), square), 0.06) == 130


@pytest.mark.parametrize(("about_x", "k1"), [(60, 0.0), (-60, -0.3), (0, -0.3)])
def test_tilt_and_barrel_distortion(make_board: MakeBoard, about_x: float, k1: float) -> None:
    board = make_board(TARGET, rotation=(about_x, 0, 5), distortion=(k1, 0.0), **WHOLE)
    assert check(board, detect_dots(as_bytes(board.draw()), TARGET), 0.15) >= 110


def test_part_of_the_board_is_in_the_frame(make_board: MakeBoard) -> None:
    board = make_board(TARGET, aim=(0.4, 0.42), rotation=(15, 10, 10), extra=2, **WHOLE | {"distance": 850.0})
    dots = detect_dots(as_bytes(board.draw()), TARGET)
    assert 40 < check(board, dots, 0.06) < 110
    assert DotFlag.CUT in dots.flag
    assert DotFlag.BEYOND_GRID in dots.flag
    assert (dots.index[dots.has_id] < 0).any()


def test_missing_dots_and_clutter_give_no_wrong_id(make_board: MakeBoard) -> None:
    rng = np.random.default_rng(4)
    rings = TARGET.ring_indices
    missing = frozenset(
        (int(c), int(r)) for c, r in TARGET.indices() if rng.random() < 0.2 and (int(c), int(r)) not in rings
    )
    board = make_board(TARGET, rotation=(25, -20, 60), missing=missing, **WHOLE | {"size": (560, 560)})
    picture = board.draw()
    for _ in range(40):
        x, y, a, b = (int(v) for v in rng.uniform((0, 0, 2, 2), (560, 560, 9, 9)))
        if min(np.hypot(*(board.centroid(ring) - (x, y))) for ring in rings) > 30:
            cv2.ellipse(
                picture, (x, y), (a, b), float(rng.uniform(0, 180)), 0, 360, float(rng.uniform(0, 200)), -1
            )
    dots = detect_dots(as_bytes(picture), TARGET)
    assert check(board, dots, 0.4) >= 60
    assert not missing & {tuple(i) for i in dots.index[dots.ok].tolist()}


def test_white_dots_are_found_for_a_target_declared_black(make_board: MakeBoard) -> None:
    white = TARGET.model_copy(update={"polarity": Polarity.WHITE_ON_BLACK})
    board = make_board(white, rotation=(10, 5, 3), **WHOLE)
    picture = as_bytes(board.draw())
    for target in (TARGET, white):
        dots = detect_dots(picture, target)
        assert check(board, dots, 0.06) == 130
        assert dots.polarity is Polarity.WHITE_ON_BLACK


def test_kinds_of_pictures_agree(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(10, 5, 3), **WHOLE)
    grey = as_bytes(board.draw())
    expected = detect_dots(grey, TARGET)
    kinds = [
        grey[..., None].repeat(3, axis=2),
        np.concatenate([grey[..., None].repeat(3, axis=2), np.full_like(grey, 255)[..., None]], axis=2),
        grey.astype(np.uint16) * 200,
        grey.astype(np.float64) / 255,
    ]
    for picture in kinds:
        dots = detect_dots(picture, TARGET)
        assert np.array_equal(dots.index, expected.index)
        assert np.nanmax(np.abs(dots.position - expected.position)) < 1e-3
    again = detect_dots(grey, TARGET)
    assert np.array_equal(again.position, expected.position, equal_nan=True)


def test_compressed_and_demosaiced_pictures(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(10, 25, 3), **WHOLE)
    grey = as_bytes(board.draw())
    mosaic = cv2.cvtColor(grey, cv2.COLOR_BayerBG2BGR)
    packed = cv2.imdecode(cv2.imencode(".jpg", grey, [cv2.IMWRITE_JPEG_QUALITY, 60])[1], cv2.IMREAD_GRAYSCALE)
    for picture in (mosaic, packed):
        assert check(board, detect_dots(picture, TARGET), 0.2) >= 125


def test_a_mirrored_picture_is_refused(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(10, 5, 3), **WHOLE)
    dots = detect_dots(np.ascontiguousarray(as_bytes(board.draw())[:, ::-1]), TARGET)
    assert dots.refusal is Refusal.MIRRORED
    assert not dots.has_id.any()


def test_another_target_and_hidden_rings_are_refused(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(10, 5, 3), **WHOLE)
    assert detect_dots(as_bytes(board.draw()), load_target("rings-14x10")).refusal is Refusal.NO_RINGS
    hidden = replace(board, missing=frozenset({TARGET.rings.x, TARGET.rings.y}))
    dots = detect_dots(as_bytes(hidden.draw()), TARGET)
    assert dots.refusal is Refusal.NO_RINGS
    assert not dots.has_id.any()
    assert len(dots.flag) > 100
    assert set(dots.flag) == {DotFlag.NO_ID}


@pytest.mark.parametrize("ring", TARGET.ring_indices)
@pytest.mark.parametrize("turn", [0, 100, 200])
def test_two_rings_do_where_the_third_is_hidden(
    make_board: MakeBoard, ring: tuple[int, int], turn: float
) -> None:
    board = make_board(
        TARGET, rotation=(20, 5, turn), missing=frozenset({ring}), **WHOLE | {"size": (560, 560)}
    )
    dots = detect_dots(as_bytes(board.draw()), TARGET)
    assert check(board, dots, 0.06) == 129
    assert [tuple(i) for i, f in zip(dots.index.tolist(), dots.flag, strict=True) if f is DotFlag.HIDDEN] == [
        ring
    ]


def test_two_rings_with_two_ways_to_number_are_refused(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(20, 5, 0), missing=frozenset({TARGET.rings.y}), **WHOLE)
    picture = board.draw()
    # Turned by half the other two rings want the third here; hide that dot as well.
    other = (TARGET.rings.x[0], TARGET.rings.x[1] - TARGET.rings.y_steps)
    x, y = (round(float(q)) for q in board.project(TARGET.points(np.array([other])))[0])
    cv2.circle(picture, (x, y), 22, 190.0, -1)
    dots = detect_dots(as_bytes(picture), TARGET)
    # Turned, the ring in column 10 would be the one in column 2 of 13, which the dots to its left rule out.
    assert dots.refusal is None


def test_part_of_a_dots_surroundings_burnt_out_is_said(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(10, 5, 3), **WHOLE)
    picture = board.draw()
    x, y = board.centroid((6, 4))
    column, line = np.meshgrid(np.arange(640), np.arange(480))
    picture += 150.0 * np.exp(-((column - x - 12) ** 2 + (line - y) ** 2) / (2 * 60.0**2))
    dots = detect_dots(as_bytes(picture), TARGET)
    flags = {tuple(i): f for i, f in zip(dots.index.tolist(), dots.flag, strict=True)}
    assert list(flags.values()).count(DotFlag.SATURATED) > 2
    check(board, dots, 0.15)


def test_a_blurred_and_a_burnt_out_picture_say_so(make_board: MakeBoard) -> None:
    board = make_board(TARGET, rotation=(10, 5, 3), **WHOLE | {"noise": 0.3})
    burnt = np.random.default_rng(3).normal(262.0, 10.0, (480, 640))
    assert detect_dots(as_bytes(burnt), TARGET).refusal is Refusal.SATURATED
    blurred = cv2.GaussianBlur(board.draw(), (0, 0), 5.0)
    assert detect_dots(as_bytes(blurred), TARGET).refusal is Refusal.BLURRED


def test_a_torn_board_gets_no_wrong_id(make_board: MakeBoard) -> None:
    # The right part is moved by half a row: each part is a fine grid, but not together.
    board = make_board(TARGET, **WHOLE)
    picture = board.draw()
    seam = round(float(board.centroid((10, 0))[0] + board.centroid((9, 0))[0]) / 2)
    step = round(float(board.centroid((0, 0))[1] - board.centroid((0, 1))[1]))
    picture[:, seam:] = np.roll(picture[:, seam:], -(step // 2), axis=0)
    dots = detect_dots(as_bytes(picture), TARGET)
    for index, seen in zip(dots.index[dots.has_id].tolist(), dots.seen_at, strict=False):
        assert np.linalg.norm(seen - board.centroid(tuple(index))) < 3


@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (13, 13), (200, 300)])
@pytest.mark.parametrize("kind", ["constant", "noise"])
def test_pictures_without_a_target_are_refused(shape: tuple[int, int], kind: str) -> None:
    picture = np.full(shape, 90, np.uint8)
    if kind == "noise":
        picture = np.random.default_rng(1).integers(0, 256, shape).astype(np.uint8)
    dots = detect_dots(picture, TARGET)
    assert dots.refusal is not None
    assert dots.size == (shape[1], shape[0])
    assert not dots.ok.any()


def test_what_is_no_picture_is_misuse() -> None:
    with pytest.raises(InputTypeError, match="uint8, uint16 or float"):
        detect_dots(np.zeros((20, 20), np.int32), TARGET)
    with pytest.raises(InputError, match="shape"):
        detect_dots(np.zeros((20, 20, 2), np.uint8), TARGET)
    with pytest.raises(InputError, match="finite"):
        detect_dots(np.full((20, 20), np.nan), TARGET)


def test_every_refusal_tells_what_to_do() -> None:
    sentences = {advice(refusal) for refusal in Refusal}
    assert len(sentences) == len(Refusal)


@pytest.mark.parametrize("grey", [60.0, 110.0, 190.0])
def test_what_a_rod_covers_or_touches_is_not_measured(make_board: MakeBoard, grey: float) -> None:
    board = make_board(TARGET, rotation=(10, -15, 20), **WHOLE)
    fine = 4
    rod = np.zeros((480 * fine, 640 * fine), np.uint8)
    cv2.line(rod, (150 * fine, -20 * fine), (520 * fine, 500 * fine), 1, 13 * fine)
    cover = cv2.GaussianBlur(rod.astype(np.float64), (0, 0), 0.6 * fine)
    cover = cover.reshape(480, fine, 640, fine).mean((1, 3))
    picture = (1.0 - cover) * board.draw() + cover * grey
    dots = detect_dots(as_bytes(picture), TARGET)
    assert check(board, dots, 0.12) > 95
    assert np.nanmax(dots.misfit) < 1.6


@pytest.mark.parametrize(("measured", "refused"), [(0, True), (3, True), (20, False)])
def test_a_picture_with_hardly_a_measured_dot_is_refused_by_name(
    make_board: MakeBoard, monkeypatch: pytest.MonkeyPatch, measured: int, *, refused: bool
) -> None:
    clean = detect_dots(as_bytes(make_board(TARGET, **WHOLE).draw()), TARGET)
    flags = tuple(DotFlag.BAD_FIT if i >= measured else flag for i, flag in enumerate(clean.flag))
    position = np.where(np.arange(len(flags))[:, None] < measured, clean.position, np.nan)
    spoilt = replace(clean, flag=flags, position=position)
    monkeypatch.setattr(detector, "_detect_dots", lambda *_: spoilt)
    found = detect_dots(as_bytes(np.zeros((9, 9))), TARGET)
    assert found.indexed is not refused
    assert (found.refusal is Refusal.NO_USABLE_DOTS) is refused
    assert found.ok.sum() == (0 if refused else measured)
    assert np.isfinite(found.position).all(axis=1).sum() == found.ok.sum()
    np.testing.assert_array_equal(found.index, clean.index)  # what each dot is stays told
