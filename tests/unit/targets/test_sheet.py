import pytest

from labcal.targets.catalogue import load_target, target_names
from labcal.targets.grid import DotGrid
from labcal.targets.sheet import CAPTION_SIZE_MM, RULER_MM, Sheet, lay_out


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
