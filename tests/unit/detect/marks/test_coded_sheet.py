"""Statuses of sheets of coded dots: another sheet, a mirror, too few dots."""

import numpy as np
import pytest

from labcal.bench.marks.drawn_picture import Exposure, drawn, tilted
from labcal.detect.detector import detect_dots
from labcal.detect.dots import PictureDots
from labcal.detect.flags import Refusal
from labcal.targets.coded_dots import RING_INNER, RING_OUTER, CodedDots
from labcal.targets.ring_codes import RingCode, code_book

SHEET = CodedDots(
    kind="coded-dots", name="sheet", code=RingCode.RING_23, first_mark=10, cols=4, rows=3, pitch_mm=9.0,
    dot_diameter_mm=2.0, margin_mm=5.0,
)  # fmt: skip


def _ink(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Return the ink of the sheet at places in mm, y up."""
    black = np.zeros(x.shape, dtype=bool)
    for (col, row), mark in zip(SHEET.indices(), SHEET.marks(), strict=True):
        word = code_book(SHEET.code).word(int(mark))
        dx, dy = x - col * SHEET.pitch_mm, y - row * SHEET.pitch_mm
        rho = np.hypot(dx, dy) / (0.5 * SHEET.dot_diameter_mm)
        # Sectors run clockwise as they are seen.
        sector = np.floor((0.3 - np.arctan2(dy, dx) / (2 * np.pi)) * len(word)).astype(int) % len(word)
        black |= (rho < 1.0) | ((rho > RING_INNER) & (rho < RING_OUTER) & word[sector])
    return np.where(black, 1.0, 0.0)


@pytest.fixture(scope="module")
def picture() -> np.ndarray:
    H = tilted(0.5, 0.7, 0.2, 500.0 / 7.0, 500.0)
    corner = H @ [13.5, 9.0, 1.0]
    H = (
        np.array([[1.0, 0, 150 - corner[0] / corner[2]], [0, 1.0, 120 - corner[1] / corner[2]], [0, 0, 1]])
        @ H
    )
    exposure = Exposure((300, 240), H, 0.7, np.zeros(2), 0.01)
    return drawn(exposure, _ink, (), np.random.default_rng(2))


def named(**changes: object) -> CodedDots:
    return CodedDots.model_validate({**SHEET.model_dump(), **changes})


def found(picture: np.ndarray, **changes: object) -> PictureDots:
    return detect_dots(picture, named(**changes))


def test_the_sheet_itself_is_measured(picture: np.ndarray) -> None:
    dots = found(picture)
    assert dots.refusal is None
    assert int(dots.ok.sum()) == SHEET.count


@pytest.mark.parametrize("changes", [{"cols": 3, "rows": 4}, {"cols": 6, "rows": 2}, {"first_mark": 9}])
def test_a_sheet_of_other_columns_is_refused_whatever_its_marks(
    picture: np.ndarray, changes: dict[str, int]
) -> None:
    dots = found(picture, **changes)
    assert dots.refusal is Refusal.OTHER_BOARD
    assert "Marks 10 to 21 of ring-23 were read" in dots.why
    assert not dots.has_id.any()


def test_marks_of_another_sheet_are_named(picture: np.ndarray) -> None:
    dots = found(picture, first_mark=40)
    assert dots.refusal is Refusal.OTHER_IDS
    assert dots.why.startswith("Marks 10 to 21 of ring-23 were read; the target has 40 to 51.")


def test_dots_that_are_too_few_are_counted(picture: np.ndarray) -> None:
    dots = found(picture[:, :92], first_mark=10)
    assert dots.refusal is Refusal.TOO_FEW_DOTS
    assert "coded dots of 12 were read" in dots.why


def test_a_mark_that_is_stuck_over_another_one_has_no_id(picture: np.ndarray) -> None:
    whole = found(picture)
    places = {tuple(key): q for key, q in zip(whole.index.tolist(), whole.position, strict=True)}
    (x, y), (u, v) = np.round(places[0, 0]).astype(int), np.round(places[2, 2]).astype(int)
    swapped = picture.copy()
    swapped[v - 22 : v + 23, u - 22 : u + 23] = picture[y - 22 : y + 23, x - 22 : x + 23]
    swapped[y - 22 : y + 23, x - 22 : x + 23] = picture[v - 22 : v + 23, u - 22 : u + 23]
    dots = found(swapped)
    assert dots.refusal is None
    assert {(0, 0), (2, 2)}.isdisjoint(map(tuple, dots.index[dots.ok].tolist()))
    assert int(dots.ok.sum()) >= SHEET.count - 4
