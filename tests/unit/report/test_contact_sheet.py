import numpy as np
import pytest

from labcal.report.contact_sheet import SheetCoverage, SheetTile, contact_sheet, plan_layout
from labcal.report.thumbnail import thumbnail


@pytest.mark.parametrize("pictures", [0, 1, 2, 3, 40, 401, 2000])
@pytest.mark.parametrize("together", [1, 2, 5, 30])
def test_a_sheet_is_never_wider_than_4000(pictures: int, together: int) -> None:
    layout = plan_layout(pictures, together, 0.75)
    assert layout.columns * layout.rows >= pictures
    assert 48 + layout.columns * (layout.box[0] + 12) <= 4000
    if 2 * together <= pictures and together <= 5:
        assert layout.columns % together == 0


def test_many_pictures_get_smaller() -> None:
    assert plan_layout(4, 2, 0.75).box[0] == 480
    assert plan_layout(2000, 2, 0.75).box[0] < 240


def test_tiles_stand_in_reading_order_and_refused_ones_in_red() -> None:
    layout = plan_layout(3, 2, 0.75)
    assert layout.columns == 2
    greys = [np.full((360, 480, 3), level, np.uint8) for level in (10, 90)]
    tiles = [
        SheetTile(greys[0], ("one",), refused=False),
        SheetTile(greys[1], ("two", "no rings"), refused=True),
        SheetTile(None, ("three", "truncated"), refused=True),
    ]
    cells = np.zeros((6, 8), np.int64)
    cells[0, 0], cells[5, 7] = 1, 9
    sheet = contact_sheet("heading", layout, tiles, [SheetCoverage("left", (640, 480), cells)])
    left, upper, wide, high = 24, 24 + 64, 492, 360 + 60 + 12
    assert (sheet[upper + 180, left + 100] == 10).all()
    assert (sheet[upper + 180, left + wide + 100] == 90).all()
    assert tuple(sheet[upper + 1, left + wide + 1]) == (190, 40, 32)
    assert (sheet[upper + 1, left + 1] == 10).all()
    assert tuple(sheet[upper + high + 1, left + 1]) == (190, 40, 32)
    top = upper + 2 * high + 24
    one, most, none = (sheet[top + y, left + x].astype(int) for x, y in ((5, 5), (425, 305), (65, 5)))
    assert most[0] < one[0] < none[0]


def test_a_line_that_is_too_long_is_cut() -> None:
    layout = plan_layout(2, 2, 0.75)
    tiles = [SheetTile(np.full((360, 480, 3), 10, np.uint8), ("word " * 60,), refused=False)]
    sheet = contact_sheet("h", layout, tiles, [])
    assert (sheet[88 + 360 : 88 + 420, 24 + 482 :] == (250, 249, 246)).all()


@pytest.mark.parametrize(
    ("picture", "expected"),
    [
        (np.full((90, 120), 77, np.uint8), 77),
        (np.full((90, 120, 3), 77 * 257, np.uint16), 77),
        (np.full((90, 120, 3), 0.5, np.float32), 186),
        (np.full((90, 120), 7.0, np.float32), 255),
    ],
    ids=["grey", "16 bit", "linear", "beyond white"],
)
def test_thumbnails_of_every_kind(picture: np.ndarray, expected: int) -> None:
    small = thumbnail(picture, 40, 60)
    assert small.shape == (30, 40, 3)
    assert (small == expected).all()
    assert thumbnail(picture, 500, 500).shape == (90, 120, 3)
