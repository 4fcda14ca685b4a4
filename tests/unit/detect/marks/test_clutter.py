"""Pictures without marks of a code: text, tags, rings of another code and photographs have no names."""

import os
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.bench.marks.coded_picture import coded_picture
from labcal.bench.marks.tags import tag_picture
from labcal.detect.marks.coded_dots import find_coded_dots
from labcal.shoot.pictures import read_picture
from labcal.targets.ring_codes import RingCode

PHOTOGRAPHS = (
    Path(os.environ.get("LABCAL_REAL_DATA", Path(__file__).parents[5] / "shared" / "real")) / "photos"
)


def text() -> np.ndarray:
    """Return a page of letters with round holes, some of them turned and soft."""
    page = np.full((300, 400), 215, np.uint8)
    random = np.random.default_rng(7)
    for row in range(9):
        letters = "".join(random.choice(list("oO0.QeadbpgB8:%@&")) for _ in range(22))
        cv2.putText(
            page, letters, (8, 30 + 32 * row), row % 4, 0.6 + 0.06 * row, 20, 1 + row // 3, cv2.LINE_AA
        )
    soft = cv2.GaussianBlur(page, (0, 0), 0.8) + random.normal(0.0, 3.0, page.shape)
    return np.clip(soft, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("code", list(RingCode))
def test_text_has_no_names(code: RingCode) -> None:
    assert not find_coded_dots(text(), code).ok.any()


def test_tags_have_no_names() -> None:
    assert not find_coded_dots(tag_picture(0, 5).picture, RingCode.RING_23).ok.any()


@pytest.mark.slow
def test_rings_of_another_code_have_no_names() -> None:
    """Half of the marks are covered in part, so that a sector more or less is easily granted."""
    for number in range(6):
        picture = coded_picture(RingCode.RING_31, number, 11).picture
        assert not find_coded_dots(picture, RingCode.RING_23).ok.any()


@pytest.mark.slow
@pytest.mark.skipif(not PHOTOGRAPHS.is_dir(), reason="no photographs: LABCAL_REAL_DATA")
def test_photographs_of_a_board_have_no_names() -> None:
    for path in sorted(PHOTOGRAPHS.iterdir())[:4]:
        assert not find_coded_dots(read_picture(path), RingCode.RING_23).ok.any()
