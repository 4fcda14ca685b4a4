"""Codes of prints in pictures: read where tags place them, refused where they lie."""

import cv2
import numpy as np
import pytest
from photographs import photograph

from labcal.detect.codes.own_board import own_board_only, own_board_where_seen
from labcal.detect.codes.reading import read_codes
from labcal.detect.codes.tag_pairs import find_blocks
from labcal.errors import InputError
from labcal.targets.artwork import ArtworkFormat, draw_artwork
from labcal.targets.catalogue import load_target
from labcal.targets.code_places import QR, QR_LEFT, tags_of
from labcal.targets.code_text import PrintedTarget, code_text
from labcal.targets.print_code import print_code

RINGS = load_target("rings-14x10")


def sheet(name: str = "rings-14x10", copy: int | None = 0) -> np.ndarray:
    """Return a print at eight pixels a millimetre."""
    drawn = draw_artwork(load_target(name), ArtworkFormat.PNG, dpi=203, copy=copy)
    picture = cv2.imdecode(np.frombuffer(drawn.content, np.uint8), cv2.IMREAD_GRAYSCALE)
    assert picture is not None
    return picture


def block_drawn(text: str, tags_say: str, px: int = 8) -> np.ndarray:
    """Return a block of a code with the tags of another text, as someone might forge it."""
    made, other = print_code(text), print_code(tags_say)
    paper = np.full((40 * px, 80 * px), 255, dtype=np.uint8)
    for cells, left, top, side in (
        (other.tags[0], 6.0, 12.0, 16.0),
        (made.qr, 26.0, 6.5, 27.0),
        (other.tags[1], 57.0, 12.0, 16.0),
    ):
        drawn = np.where(cells, 0, 255).astype(np.uint8)
        size = round(side * px)
        at = (round(top * px), round(left * px))
        scaled = cv2.resize(drawn, (size, size), interpolation=cv2.INTER_NEAREST)
        paper[at[0] : at[0] + size, at[1] : at[1] + size] = scaled
    return paper


def test_a_webcam_reads_it_at_45_degrees() -> None:
    picture = photograph(sheet(copy=3), (1280, 960), fill=0.8, tilt_deg=45.0, axis_deg=37.0)
    found = read_codes(picture)
    assert [one.name for one in found.prints] == ["rings-14x10#3"]
    assert found.prints[0].target == RINGS
    assert (found.refused, found.foreign, len(found.blocks)) == ((), (), 1)


def test_a_small_code_is_read_after_sharpening() -> None:
    picture = photograph(sheet(), (1280, 960), fill=0.25, tilt_deg=0.0, axis_deg=0.0)
    assert [one.name for one in read_codes(picture).prints] == ["rings-14x10"]


def test_the_tags_are_seen_where_the_code_is_too_small() -> None:
    picture = photograph(sheet(), (1280, 960), fill=0.2, tilt_deg=0.0, axis_deg=0.0)
    found = read_codes(picture)
    assert found.prints == ()
    assert [block.is_whole for block in found.blocks] == [True]


def test_the_block_s_homography_places_the_code() -> None:
    picture = sheet()
    (block,) = find_blocks(picture)
    corners = block.places(np.array([[QR_LEFT, 0.0], [QR_LEFT + QR, QR]]))
    rows, cols = (
        np.flatnonzero(picture[-300:].min(axis=1) < 9),
        np.flatnonzero(picture[-300:].min(axis=0) < 9),
    )
    assert len(rows) > 0
    assert len(cols) > 0
    px = 203 / 25.4
    assert (corners[1] - corners[0]) == pytest.approx([QR * px, QR * px], abs=0.3)
    at = np.floor(corners[0] + 1.5).astype(int)
    assert picture[at[1], at[0]] == 0  # the first cell of a corner mark


@pytest.mark.parametrize("dtype", [np.uint16, np.float32])
def test_other_kinds_of_pictures_and_colour_are_read(dtype: type) -> None:
    picture = (photograph(sheet(), (900, 700), 0.9, 0.0, 0.0).astype(np.float64) * 100.0).astype(dtype)
    assert len(read_codes(np.repeat(picture[..., None], 3, axis=2)).prints) == 1


def test_a_picture_without_any_code_tells_nothing() -> None:
    random = np.random.default_rng(3)
    for picture in (np.zeros((8, 8), np.uint8), np.full((300, 300), 7, np.uint8), sheet(copy=None)):
        found = read_codes(picture)
        assert (found.prints, found.blocks, found.refused, found.foreign) == ((), (), (), ())
    assert read_codes(random.integers(0, 255, (200, 300)).astype(np.uint8)).prints == ()


def test_a_code_of_someone_else_is_passed_over() -> None:
    drawn = np.asarray(cv2.QRCodeEncoder.create().encode("https://example.org"))
    picture = np.pad(
        cv2.resize(drawn, None, fx=8, fy=8, interpolation=cv2.INTER_NEAREST), 60, constant_values=255
    )
    found = read_codes(picture)
    assert found.prints == ()
    assert found.foreign == ("https://example.org",)


def test_a_code_between_the_tags_of_another_print_is_not_believed() -> None:
    honest, other = code_text(RINGS), code_text(load_target("plain-11x8"))
    assert len(read_codes(block_drawn(honest, honest)).prints) == 1
    found = read_codes(block_drawn(honest, other))
    assert found.prints == ()
    assert "is between the tags" in found.refused[0]


def test_a_code_with_absurd_sizes_is_not_believed() -> None:
    forged = code_text(RINGS).replace(":14X10:", ":1000X1000:")
    found = read_codes(block_drawn(forged, forged))
    assert found.prints == ()
    assert "checksum" in found.refused[0]


def test_the_dots_of_the_other_board_are_hidden() -> None:
    first, second = sheet("plain-11x8", 1), sheet("plain-11x8", 2)
    both = np.hstack([first, np.full((len(first), 60), 150, np.uint8), second])
    picture = photograph(both, (1600, 900), fill=0.8, tilt_deg=30.0, axis_deg=37.0)
    for copy, own in ((1, np.s_[:, :700]), (2, np.s_[:, 900:])):
        seen = own_board_only(picture, PrintedTarget(load_target("plain-11x8"), copy))
        other = np.s_[:, 900:] if copy == 1 else np.s_[:, :700]
        assert np.ptp(seen[other]) == 0
        assert np.ptp(seen[own]) > 100


def test_a_picture_of_another_print_only_is_refused() -> None:
    picture = photograph(sheet("plain-11x8", 1), (1000, 800), 0.8, 0.0, 0.0)
    with pytest.raises(InputError, match="another print"):
        own_board_only(picture, PrintedTarget(RINGS))
    assert own_board_where_seen(picture, RINGS) is picture  # named: it may be an old print without a code


def test_two_prints_alike_are_refused() -> None:
    one = sheet()
    with pytest.raises(InputError, match="two prints"):
        own_board_only(np.hstack([one, one]), PrintedTarget(RINGS))


def test_tags_below_87_are_left_to_laboratories() -> None:
    assert tags_of(0) == (87, 88)
    assert tags_of(249) == (585, 586)
