import pytest

from labcal.targets.catalogue import load_target, target_names
from labcal.targets.code_places import BLOCK_HEIGHT, BLOCK_WIDTH
from labcal.targets.grid import DotGrid
from labcal.targets.sheet import CAPTION_SIZE_MM, RULER_MM, Sheet, lay_out, lay_out_with_code


def below_the_board(sheet: Sheet) -> list[float]:
    """Return the upper edges of what is printed beside the target."""
    return [sheet.ruler[1], *(caption.y + CAPTION_SIZE_MM for caption in sheet.captions)]


@pytest.mark.parametrize("margin", [0.0, 1.0, 10.0, 300.0])
@pytest.mark.parametrize("columns", [5, 40])
def test_everything_lies_on_the_paper_and_clear_of_the_dots(
    margin: float, columns: int, grid: DotGrid
) -> None:
    target = grid.model_copy(update={"margin_mm": margin, "cols": columns})
    sheet = lay_out(target)
    paper, board = sheet.paper, sheet.board
    radius = target.outer_diameters_mm().max() / 2
    points = target.points()
    assert board.x_min <= points[:, 0].min() - radius
    assert board.y_min <= points[:, 1].min() - radius
    assert board.x_max >= points[:, 0].max() + radius
    assert board.y_max >= points[:, 1].max() + radius
    assert paper.x_min < board.x_min < board.x_max < paper.x_max
    assert paper.y_min < board.y_min < board.y_max < paper.y_max
    assert max(below_the_board(sheet)) < board.y_min
    assert min(caption.y for caption in sheet.captions) > paper.y_min
    assert paper.x_min < sheet.ruler[0]
    assert sheet.ruler[0] + RULER_MM < paper.x_max


@pytest.mark.parametrize("name", target_names())
def test_the_board_of_a_shipped_target_is_its_extent(name: str) -> None:
    target = load_target(name)
    board = lay_out(target).board
    assert (board.x_min, board.y_min, board.x_max, board.y_max) == target.extent_mm


def test_the_captions_say_name_pitch_and_how_to_print(grid: DotGrid) -> None:
    text = "\n".join(caption.text for caption in lay_out(grid).captions)
    for said in ("small", "5 x 4 dots", "20 mm x 12.5 mm", "print at 100 %, check the ruler"):
        assert said in text


@pytest.mark.parametrize("margin", [0.0, 1.0, 10.0, 300.0])
@pytest.mark.parametrize("columns", [2, 5, 40])
def test_a_code_lies_on_the_paper_and_apart_from_all_else(margin: float, columns: int, grid: DotGrid) -> None:
    changes = {"margin_mm": margin, "cols": columns, "rings": None}
    target = grid.model_copy(
        update={**changes, "ring_outer_diameter_mm": None, "ring_inner_diameter_mm": None}
    )
    sheet = lay_out_with_code(target)
    assert sheet.code is not None
    left, top, unit = sheet.code.left, sheet.code.top, sheet.code.unit
    right, bottom = left + unit * BLOCK_WIDTH, top - unit * BLOCK_HEIGHT
    cut, paper = sheet.cut, sheet.paper
    assert cut.x_min < left < right < cut.x_max
    assert cut.y_min < bottom < top < sheet.board.y_min - 3.9 * unit  # white around the code
    assert paper.x_min < cut.x_min < cut.x_max < paper.x_max
    assert paper.y_min < cut.y_min
    ruler_top, ruler_right = sheet.ruler[1], sheet.ruler[0] + RULER_MM
    assert ruler_right < left or ruler_top < bottom - 3.0
    assert ruler_right < cut.x_max
    assert sheet.ruler[0] > cut.x_min
    for caption in sheet.captions:
        width = 0.62 * sheet.caption_mm * len(caption.text)
        assert caption.x + width < left or caption.y + sheet.caption_mm < bottom
        assert cut.y_min < caption.y
        assert caption.x + width < cut.x_max


@pytest.mark.parametrize("name", target_names())
def test_the_code_of_a_shipped_target_takes_hardly_more_paper_in_width(name: str) -> None:
    target = load_target(name)
    coded, plain = lay_out_with_code(target, 2), lay_out(target)
    assert coded.paper.width <= plain.paper.width + 1.0
    assert coded.code is not None
    assert "copy 2" in "".join(caption.text for caption in coded.captions)


def test_the_asymmetric_grid_with_its_code_fits_a4() -> None:
    paper = lay_out_with_code(load_target("asymmetric-4x11")).paper
    assert paper.width <= 210.0
    assert paper.height <= 297.0
