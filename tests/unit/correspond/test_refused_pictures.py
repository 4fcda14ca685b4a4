"""Reasons that many pictures share, and pictures that are left out."""

from pathlib import Path

import pytest

from labcal.correspond.pictures_left_out import left_out_words
from labcal.correspond.refused_pictures import no_picture_left, shared_reasons
from labcal.correspond.sources import loose_sources
from labcal.errors import InputError


def test_a_reason_is_told_once_with_the_first_names() -> None:
    refused = [(f"p/{n}.png", "no-grid: Look again.") for n in range(14)]
    refused.insert(3, ("p/x.png", "blurred: Focus."))
    grid, blurred = shared_reasons(refused)
    assert grid.words == "14 pictures (p/0.png, p/1.png, p/2.png and 11 more): no-grid: Look again."
    assert blurred.words == "p/x.png: blurred: Focus."


def test_a_reason_that_names_its_picture_is_the_same_of_another() -> None:
    refused = [(f"{n}.png", f"The picture {n}.png is truncated.") for n in ("a", "b", "c", "d")]
    (truncated,) = shared_reasons(refused)
    assert (
        truncated.words
        == "4 pictures (a.png, b.png, c.png and 1 more), the first one: The picture a.png is truncated."
    )
    assert shared_reasons(refused[:1])[0].words == "The picture a.png is truncated."
    assert (
        str(no_picture_left(refused)) == "None of the 4 pictures can be used. The picture a.png is truncated."
    )
    assert str(no_picture_left(refused[1:2])).startswith("The only picture cannot be used. The picture b.png")
    both = no_picture_left([*refused, ("e.png", "blurred: Focus.")])
    assert str(both).endswith("the first one: The picture a.png is truncated. e.png: blurred: Focus.")


def test_pictures_of_other_formats_are_told_with_how_to_convert_them(tmp_path: Path) -> None:
    for name in ("a.gif", "b.GIF", "c.jp2", "d.CR2", "e.png", "f.txt"):
        (tmp_path / name).write_bytes(b"x")
    (tmp_path / "inside").mkdir()
    (tmp_path / "inside" / "g.heic").write_bytes(b"x")  # not looked at: there are pictures beside it
    other, raw = left_out_words([str(tmp_path)])
    assert other.startswith("3 pictures left out, since files that end in .gif, .jp2 are not read: ")
    assert "-format png" in other
    assert "g.heic" not in other
    assert raw.startswith("1 picture left out, since files that end in .cr2 are not read: ")
    assert "TIFF of 16 bits" in raw
    assert left_out_words([str(tmp_path / "a.gif")]) == []
    (tmp_path / "e.png").unlink()
    assert (
        "g.heic" in left_out_words([str(tmp_path)])[0] or "4 pictures" in left_out_words([str(tmp_path)])[0]
    )


@pytest.mark.parametrize(
    ("names", "endings"),
    [
        (("a.png", "A.png"), {}),
        (("a_0.png", "b_1.png"), {"_0": "left", "_1": "Left"}),
        (("x_0.png", "X_1.png"), {"_0": "left", "_1": "right"}),
    ],
)
def test_names_that_differ_in_capitals_alone_are_refused(
    tmp_path: Path, names: tuple[str, ...], endings: dict[str, str]
) -> None:
    for name in names:
        (tmp_path / name).write_bytes(b"x")
    if len(list(tmp_path.iterdir())) < len(names):
        pytest.skip("this disk does not tell capital letters apart")
    with pytest.raises(InputError, match=r"differ only in capital letters.*Rename"):
        loose_sources([str(tmp_path)], endings)
