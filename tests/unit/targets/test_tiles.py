import shutil
import subprocess
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.errors import InputError, UnknownNameError
from labcal.targets.catalogue import load_target, target_names
from labcal.targets.page_artwork import PageSettings, export_pages
from labcal.targets.paper import PAPERS, PRINTER_MARGIN_MM, Paper, paper_of, smallest_paper
from labcal.targets.sheet import lay_out, lay_out_print
from labcal.targets.tiles import LABEL_MM, OVERLAP_MM, Tiling, tiled


@pytest.mark.parametrize(
    ("text", "sides"),
    [("a4", (210, 297)), ("A3", (297, 420)), ("300x200", (200, 300)), ("Letter", (215.9, 279.4))],
)
def test_paper_has_a_name_or_sides(text: str, sides: tuple[float, float]) -> None:
    paper = paper_of(text)
    assert (paper.width_mm, paper.height_mm) == sides
    assert paper.holds(float(sides[1]), float(sides[0]))
    assert not paper.holds(sides[1] + 1.0, float(sides[0]))


def test_paper_that_is_none_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="a4"):
        paper_of("a44")
    with pytest.raises(InputError, match="sides"):
        paper_of("1x2")


def test_shipped_targets_for_a4_leave_room_for_the_code() -> None:
    for name in ("webcam-a4", "machine-a4"):
        paper = lay_out(load_target(name)).paper
        assert PAPERS["a4"].holds(paper.width, paper.height + 2)
    assert smallest_paper(load_target("charuco-12x9")) == PAPERS["a3"]


CASES = [("plain-11x8", "a4", None), ("paper-13x10", "a3", None), ("plain-11x8", "a4", (2, 2))]


@pytest.mark.parametrize(
    ("name", "paper", "counts"), [*CASES, *((name, "a4", None) for name in target_names())]
)
def test_tiles_cover_the_sheet_overlap_and_fit_their_page(
    name: str, paper: str, counts: tuple[int, int] | None
) -> None:
    target = load_target(name)
    sheet = lay_out_print(target, 0)
    tiling = tiled(target, sheet, paper_of(paper), counts)
    across, up = tiling.counts
    assert len(tiling.tiles) == across * up
    by_place = {(tile.col, tile.row): tile.window for tile in tiling.tiles}
    if len(tiling.tiles) == 1:
        window = by_place[0, 0]
        assert (window.width, window.height) == pytest.approx(tiling.page_mm)
        return
    assert by_place[0, 0].x_min == sheet.paper.x_min
    assert by_place[across - 1, up - 1].y_max == sheet.paper.y_max
    for (col, row), window in by_place.items():
        assert window.width <= tiling.page_mm[0] - 2 * PRINTER_MARGIN_MM + 1e-6
        assert window.height <= tiling.page_mm[1] - 2 * PRINTER_MARGIN_MM - LABEL_MM + 1e-6
        if (col + 1, row) in by_place:
            assert window.x_max - by_place[col + 1, row].x_min == pytest.approx(OVERLAP_MM)
        if (col, row + 1) in by_place:
            assert window.y_max - by_place[col, row + 1].y_min == pytest.approx(OVERLAP_MM)


def test_cuts_run_between_dots() -> None:
    target = load_target("paper-13x10")
    tiling = tiled(target, lay_out(target), paper_of("a3"))
    for axis, cuts in enumerate((tiling.cuts_x, tiling.cuts_y)):
        away = np.abs(target.points()[:, axis, None] - np.array(cuts))
        assert away.min() > 0.5 * target.outer_diameters_mm().max()


def test_a_sheet_that_does_not_fit_is_refused_by_numbers() -> None:
    target = load_target("plain-11x8")
    with pytest.raises(InputError, match="it takes 2 x 1"):
        tiled(target, lay_out(target), paper_of("a4"), (1, 1))
    with pytest.raises(InputError, match="cannot be cut"):
        tiled(load_target("paper-13x10"), lay_out(load_target("paper-13x10")), Paper("40x50", 40.0, 50.0))


def test_pages_are_the_same_bytes_and_pdf_alone(tmp_path: Path) -> None:
    target = load_target("plain-11x8")
    export_pages(target, tmp_path / "a.pdf", PageSettings(PAPERS["a4"]))
    export_pages(target, tmp_path / "b.pdf", PageSettings(PAPERS["a4"]))
    assert (tmp_path / "a.pdf").read_bytes() == (tmp_path / "b.pdf").read_bytes()
    assert (tmp_path / "a.pdf").read_bytes().count(b"/Type /Page ") == 2
    with pytest.raises(InputError, match="PDF"):
        export_pages(target, tmp_path / "a.svg", PageSettings(PAPERS["a4"]))


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("pdftoppm") is None, reason="needs pdftoppm (Debian: poppler-utils)")
@pytest.mark.parametrize(("name", "paper", "counts"), [*CASES, ("webcam-a4", "a4", (1, 1))])
def test_rasterised_pages_have_the_right_pitch(
    name: str, paper: str, counts: tuple[int, int] | None, tmp_path: Path
) -> None:
    target = load_target(name)
    tiling: Tiling = export_pages(target, tmp_path / "t.pdf", PageSettings(paper_of(paper), counts))
    dpi = 600 if target.outer_diameters_mm().max() < 20 else 150
    subprocess.run(["pdftoppm", "-r", str(dpi), "-gray", "-png", "t.pdf", "page"], cwd=tmp_path, check=True)  # noqa: S607
    for page in sorted(tmp_path.glob("page*.png")):
        picture = cv2.imread(str(page), cv2.IMREAD_GRAYSCALE)
        assert picture is not None
        mm = 25.4 / dpi
        _, _, boxes, centres = cv2.connectedComponentsWithStats((picture < 128).astype(np.uint8))
        wide = np.abs(boxes[:, 2:4] * mm - target.outer_diameters_mm().max()).max(axis=1) < 0.2
        place = centres[wide] * mm * [1, -1]
        points = target.points()[:, :2]
        # Whole pitches apart, whichever dots the page shows.
        for axis in (0, 1):
            pitch = np.diff(np.unique(points[:, axis].round(6))).min()
            away = place[:, axis] - place[0, axis]
            assert np.abs(away - pitch * np.round(away / pitch)).max() < 0.02
    assert len(list(tmp_path.glob("page*.png"))) == len(tiling.tiles)


def test_a_wide_rim_of_the_printer_makes_smaller_parts() -> None:
    target = load_target("plain-11x8")
    for margin in (5.0, 20.0):
        tiling = tiled(target, lay_out(target), PAPERS["a4"], None, margin)
        assert tiling.margin_mm == margin
        assert all(
            tile.window.height <= tiling.page_mm[1] - 2 * margin - LABEL_MM + 1e-6 for tile in tiling.tiles
        )
