"""ChArUco boards against OpenCV's own: places, ids, colours, markers, and the print."""

import cv2
import numpy as np
import pytest
from pydantic import ValidationError

from labcal.errors import InputError
from labcal.targets.artwork import ArtworkFormat, draw_artwork
from labcal.targets.catalogue import load_target
from labcal.targets.charuco import CharucoBoard, MarkerDictionary, Pattern
from labcal.targets.charuco_opencv import markers, opencv_board, opencv_dictionary
from labcal.targets.sheet import lay_out
from labcal.targets.target import Target

BOARD = load_target("charuco-12x9")
SMALL = {
    "kind": "charuco", "name": "small", "squares": (5, 4), "square_mm": 10.0, "marker_mm": 7.0,
    "dictionary": "DICT_4X4_50", "margin_mm": 3.0,
}  # fmt: skip


def test_it_is_a_target_like_any_other() -> None:
    assert isinstance(BOARD, CharucoBoard)
    assert isinstance(BOARD, Target)
    assert (BOARD.cols, BOARD.rows, BOARD.count) == (11, 8, 88)
    assert np.array_equal(BOARD.points()[12], [20.0, 20.0, 0.0])  # (1, 1)
    assert np.array_equal(BOARD.points(np.array([[3, 0]])), [[60.0, 0.0, 0.0]])
    assert BOARD.extent_mm == (-30.0, -30.0, 230.0, 170.0)
    assert not BOARD.outer_diameters_mm().any()
    assert BOARD.symmetric_indices(BOARD.indices()) == ()


@pytest.mark.parametrize("pattern", Pattern)
@pytest.mark.parametrize("squares", [(5, 4), (4, 5), (12, 9)])
def test_corners_are_where_opencv_has_them(squares: tuple[int, int], pattern: Pattern) -> None:
    board = CharucoBoard.model_validate(
        SMALL | {"squares": squares, "pattern": pattern, "dictionary": "DICT_6X6_250"}
    )
    theirs = opencv_board(board)
    corners = np.array(theirs.getChessboardCorners(), dtype=np.float64)
    index = board.from_opencv(np.arange(len(corners)))
    np.testing.assert_allclose(board.points(index), board.points_from_opencv(corners), atol=1e-5)
    assert {tuple(key) for key in index.tolist()} == {tuple(key) for key in board.indices().tolist()}
    # Calibration by OpenCV pairs ids and places in its own way; ours differ by a rigid motion only.
    seen = np.arange(2.0 * len(corners), dtype=np.float32).reshape(-1, 1, 2)
    paired, _ = theirs.matchImagePoints(seen, np.arange(len(corners), dtype=np.int32))
    paired = np.asarray(paired, dtype=np.float64).reshape(-1, 3)
    motion = np.linalg.lstsq(
        np.concatenate([paired, np.ones((len(paired), 1))], axis=1), board.points(index), rcond=None
    )[0]
    np.testing.assert_allclose(motion[:2, :2], np.diag([1.0, -1.0]), atol=1e-6)  # y is down there, z into it


@pytest.mark.parametrize("pattern", Pattern)
@pytest.mark.parametrize("squares", [(5, 4), (6, 5)])
def test_the_print_is_opencv_s(squares: tuple[int, int], pattern: Pattern) -> None:
    board = CharucoBoard.model_validate(SMALL | {"squares": squares, "pattern": pattern})
    artwork = draw_artwork(board, ArtworkFormat.PNG, dpi=254, copy=None)  # ten pixels a millimetre
    drawn = cv2.imdecode(np.frombuffer(artwork.content, np.uint8), cv2.IMREAD_GRAYSCALE)
    sheet = lay_out(board)
    left = round(10 * (-board.square_mm - sheet.paper.x_min))
    top = round(10 * (sheet.paper.y_max - board.rows * board.square_mm))
    width, height = (round(10 * board.square_mm * count) for count in squares)
    ours = drawn[top : top + height, left : left + width]
    theirs = opencv_board(board).generateImage((width, height), marginSize=0, borderBits=1)
    # The edges of a marker's cells fall between pixels here and there.
    inside = cv2.dilate(theirs, np.ones((5, 5))) == cv2.erode(theirs, np.ones((5, 5)))
    assert inside.mean() > 0.5
    np.testing.assert_array_equal(ours[inside] > 127, theirs[inside] > 127)
    assert (drawn[top - 25 : top - 5, left : left + width] == 255).all()  # bare margin


def test_opencv_reads_the_print() -> None:
    artwork = draw_artwork(BOARD, ArtworkFormat.PNG, dpi=100)
    drawn = cv2.imdecode(np.frombuffer(artwork.content, np.uint8), cv2.IMREAD_GRAYSCALE)
    _, ids, _, marker_ids = cv2.aruco.CharucoDetector(opencv_board(BOARD)).detectBoard(drawn)
    assert (len(ids), len(marker_ids)) == (88, 54)


def test_markers_lie_in_the_middle_of_white_squares() -> None:
    found = markers(BOARD)
    assert found.is_black.shape == (BOARD.marker_count, 7, 7)
    middle = (found.corner + 7.5) / 20.0
    square = np.floor(middle).astype(int) + 1  # counted from the lower left square
    np.testing.assert_allclose(middle - np.floor(middle), 0.5)
    assert not BOARD.is_black(square[:, 0], square[:, 1]).any()
    assert found.is_black[:, 0].all()  # the border


@pytest.mark.parametrize("name", MarkerDictionary)
def test_dictionaries_are_as_large_as_stated(name: MarkerDictionary) -> None:
    assert len(opencv_dictionary(name).bytesList) == name.size


@pytest.mark.parametrize(
    ("changes", "said"),
    [
        ({"marker_mm": 10.0}, "smaller than square_mm"),
        ({"squares": (12, 9)}, "54 markers, but DICT_4X4_50 has 50"),
        ({"squares": (2, 9)}, "greater than or equal to 3"),
        ({"dictionary": "DICT_9X9_50"}, "DICT_4X4_50"),
        ({"rings": None}, "Extra inputs"),
        ({"kind": "chessboard"}, "'charuco'"),
    ],
)
def test_what_cannot_be_is_refused(changes: dict[str, object], said: str) -> None:
    with pytest.raises(ValidationError, match=said):
        CharucoBoard.model_validate(SMALL | changes)


def test_an_unknown_kind_in_a_file_is_refused(tmp_path) -> None:  # type: ignore[no-untyped-def]  # noqa: ANN001 - pytest's
    path = tmp_path / "x.yaml"
    path.write_text("kind: honeycomb\nname: x\n")
    with pytest.raises(InputError, match="Known: aprilgrid, boards, charuco"):
        load_target(str(path))


def test_markers_count_from_the_first_id() -> None:
    board = CharucoBoard.model_validate(SMALL | {"first_id": 7})
    last = 7 + board.marker_count - 1
    assert opencv_board(board).getIds().ravel().tolist() == list(range(7, last + 1))
    plain = markers(CharucoBoard.model_validate(SMALL))
    np.testing.assert_array_equal(markers(board).corner, plain.corner)
    assert (markers(board).is_black != plain.is_black).any()
    assert "markers from 7" in board.captions[0]
    assert "from" not in CharucoBoard.model_validate(SMALL).captions[0]


def test_the_last_id_must_be_in_the_dictionary() -> None:
    size = CharucoBoard.model_validate(SMALL).dictionary.size
    with pytest.raises(ValueError, match=r"ends at \d+: lower first_id"):
        CharucoBoard.model_validate(SMALL | {"first_id": size - 3})
