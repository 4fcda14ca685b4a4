"""Sheets of coded dots: their description, and their print read back."""

from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.detect.detector import detect_dots
from labcal.detect.flags import Refusal
from labcal.errors import InputError
from labcal.targets.artwork import export_artwork
from labcal.targets.catalogue import load_target
from labcal.targets.coded_dots import CodedDots
from labcal.targets.ring_codes import RingCode
from labcal.targets.sheet import lay_out

DPI = 150


def sheet(**changes: object) -> CodedDots:
    values = {
        "kind": "coded-dots", "name": "few", "code": "ring-23", "first_mark": 100, "cols": 4, "rows": 3,
        "pitch_mm": 20.0, "dot_diameter_mm": 4.0, "margin_mm": 10.0,
    }  # fmt: skip
    return CodedDots.model_validate(values | changes)


def printed(board: CodedDots, folder: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the print as a picture, and where its dots are."""
    path = folder / "sheet.png"
    export_artwork(board, path, dpi=DPI, copy=None)
    paper = cv2.imread(str(path), cv2.IMREAD_GRAYSCALE)
    assert paper is not None
    around = lay_out(board).paper
    origin = np.array([around.x_min, around.y_max])
    return paper, (board.points()[:, :2] - origin) * [DPI / 25.4, -DPI / 25.4] - 0.5


def test_marks_are_numbered_along_the_rows_from_the_first() -> None:
    board = sheet(first_mark=7)
    assert board.marks().tolist() == list(range(7, 19))
    assert board.marks(np.array([[1, 2]])).tolist() == [16]
    assert (board.outer_diameters_mm() == 4.0).all()


@pytest.mark.parametrize("changes", [{"first_mark": 101}, {"pitch_mm": 15.9}, {"code": "ring-24"}])
def test_marks_that_the_code_has_not_and_rings_that_touch_are_refused(changes: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=r"112 marks|4 times|ring-23"):
        sheet(**changes)


@pytest.mark.parametrize("code", RingCode)
def test_a_print_is_read_back_dot_for_dot(code: RingCode, tmp_path: Path) -> None:
    board = sheet(code=code)
    paper, q = printed(board, tmp_path)
    dots = detect_dots(cv2.GaussianBlur(paper, (0, 0), 0.8), board)
    assert dots.ok.sum() == board.count
    assert dots.index[dots.ok].tolist() == board.indices().tolist()
    assert np.abs(dots.position[dots.ok] - q).max() < 0.02


def test_a_mirrored_print_and_that_of_another_code_have_no_numbers(tmp_path: Path) -> None:
    board = sheet()
    paper, _ = printed(board, tmp_path)
    soft = cv2.GaussianBlur(paper, (0, 0), 0.8)
    assert detect_dots(np.ascontiguousarray(soft[:, ::-1]), board).refusal is Refusal.MIRRORED
    assert detect_dots(soft, sheet(code="ring-31")).refusal is Refusal.NO_CODED_DOTS
    assert detect_dots(soft, sheet(first_mark=0)).refusal is Refusal.OTHER_IDS


def test_the_shipped_sheet_is_one() -> None:
    target = load_target("coded-8x6")
    assert isinstance(target, CodedDots)
    assert target.marks()[-1] == 47


def test_a_file_with_a_mistake_is_refused_by_name(tmp_path: Path) -> None:
    path = tmp_path / "bad.yaml"
    path.write_text(
        "kind: coded-dots\nname: bad\ncode: ring-23\ncols: 20\nrows: 6\npitch_mm: 20\ndot_diameter_mm: 4\n"
    )
    with pytest.raises(InputError, match="has 112 marks"):
        load_target(path)
