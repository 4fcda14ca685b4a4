"""The page: all figures of the document, nothing from elsewhere, the same bytes twice."""

import base64
import re
from html.parser import HTMLParser
from pathlib import Path

import cv2
import numpy as np
import pytest

from labcal.errors import InputError
from labcal.report.reproduction import Reproduction, ShownPicture, read_reproduction
from labcal.report.reproduction_page import missing_pictures, reproduction_page
from labcal.run.json_text import to_json
from labcal.shoot.pictures import write_picture

VOID = {"meta", "link", "img", "br"}


class Outline(HTMLParser):
    """Collects ids, links and the rows of the table, and checks that elements are nested."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.ids: list[str] = []
        self.sources: list[str] = []
        self.cells: dict[str, str] = {}
        self.row = ""

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        given = {name: value or "" for name, value in attrs}
        if "id" in given:
            self.ids.append(given["id"])
        self.sources += [given[name] for name in ("src", "href", "xlink:href", "action") if name in given]
        if tag == "tbody":
            self.row = given.get("id", "")
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.open.pop()

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        if "tbody" in self.open:
            self.cells[self.row] = self.cells.get(self.row, "") + " " + " ".join(data.split())


def outline_of(page: str) -> Outline:
    outline = Outline()
    outline.feed(page)
    assert outline.open == []
    return outline


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    (tmp_path / "shoots").mkdir()
    picture = np.zeros((900, 1200, 3), np.uint8)
    picture[:, 600:] = (250, 10, 10)
    write_picture(tmp_path / "shoots" / "a.png", picture)
    return tmp_path


def test_every_row_stands_on_the_page_beside_the_papers(made_up: Reproduction, folder: Path) -> None:
    outline = outline_of(reproduction_page(made_up, folder))
    assert [name for name in outline.cells if name.startswith("row-")] == [
        f"row-{number:02}" for number in range(1, 24)
    ]
    row_20 = outline.cells["row-20"]
    for text in ("50-3", "+0.01178", "−0.28720", "−2%", "58.9", "1253", "358", "paper contradicts itself"):  # noqa: RUF001 - as printed
        assert text in row_20
    assert "coordinates of 14 m" in row_20
    assert "goal not reached" in outline.cells["row-22"]
    assert "not reported" in outline.cells["row-16"]
    assert outline.cells["row-05"].count("noise 5% of") == 7  # six readings, and the row's own


def test_the_page_needs_nothing_beside_it(made_up: Reproduction, folder: Path) -> None:
    page = reproduction_page(made_up, folder)
    outline = outline_of(page)
    assert all(source.startswith(("#", "data:image/")) for source in outline.sources)
    targets = [source[1:] for source in outline.sources if source.startswith("#")]
    targets += re.findall(r"url\(#([^)]*)\)", page)
    assert len(targets) > 40
    assert set(targets) <= set(outline.ids)
    assert len(outline.ids) == len(set(outline.ids))
    assert "http:" not in page
    assert "https:" not in page
    assert "@import" not in page
    assert page.count("<svg") == 2
    assert page.count("<style") == 2


def test_pictures_are_embedded_small_in_their_colours(made_up: Reproduction, folder: Path) -> None:
    page = reproduction_page(made_up, folder)
    (data,) = re.findall(r"data:image/jpeg;base64,([^\"]*)", page)
    picture = cv2.imdecode(np.frombuffer(base64.b64decode(data), np.uint8), cv2.IMREAD_COLOR)
    assert picture is not None
    assert picture.shape == (480, 640, 3)
    assert 'width="640" height="480"' in page
    np.testing.assert_allclose(picture[240, 600, ::-1], (250, 10, 10), atol=4)
    np.testing.assert_allclose(picture[240, 40], 0, atol=4)


def test_the_same_page_twice(made_up: Reproduction, folder: Path) -> None:
    assert reproduction_page(made_up, folder) == reproduction_page(made_up, folder)


def test_a_quick_run_says_so_and_a_full_one_does_not(made_up: Reproduction, folder: Path) -> None:
    assert "16 rays a pixel" in reproduction_page(made_up, folder)
    full = made_up.model_copy(update={"quick": False, "restrictions": ()})
    assert "quick run" not in reproduction_page(full, folder).lower()


def test_text_of_the_document_is_no_markup(made_up: Reproduction, folder: Path) -> None:
    hostile = made_up.model_copy(update={"restrictions": ("<script>alert(1)</script>",)})
    page = reproduction_page(hostile, folder)
    assert "<script>alert" not in page
    assert "&lt;script&gt;" in page


@pytest.mark.parametrize("file", ["shoots/gone.png", "../secret.png"])
def test_missing_and_outside_pictures_are_said_and_not_shown(
    made_up: Reproduction, folder: Path, file: str
) -> None:
    inside = folder / "inside"
    inside.mkdir()
    write_picture(folder / "secret.png", np.zeros((4, 4, 3), np.uint8))
    shown = ShownPicture(scene="s", caption="caption", file=file)
    changed = made_up.model_copy(update={"pictures": (shown,)})
    assert missing_pictures(changed, inside) == [file]
    page = reproduction_page(changed, inside)
    assert "data:image" not in page
    assert file in page


def test_few_rows_and_null_figures(made_up: Reproduction, tmp_path: Path) -> None:
    odd = made_up.rows[9].model_copy(update={"rel": float("nan"), "max_mm": float("nan")})
    few = made_up.model_copy(update={"rows": (odd,), "pictures": ()})
    (tmp_path / "results.json").write_text(to_json(few))
    read = read_reproduction(tmp_path)
    assert np.isnan(read.rows[0].rel)
    outline = outline_of(reproduction_page(read, tmp_path))
    assert "–" in outline.cells["row-10"]  # noqa: RUF001 - as printed


def test_a_verdict_of_another_version_is_refused(made_up: Reproduction, tmp_path: Path) -> None:
    text = to_json(made_up).replace('"verdict": "matches"', '"verdict": "reproduced"', 1)
    (tmp_path / "results.json").write_text(text)
    with pytest.raises(InputError, match="'reproduced' is none of 'matches'"):
        read_reproduction(tmp_path)


@pytest.mark.parametrize("name", ["$$", r"$\frac{", "😀", "<b>", '"&'])
def test_names_of_rows_are_no_formulas_and_no_markup(name: str, made_up: Reproduction, folder: Path) -> None:
    row = made_up.rows[0].model_copy(update={"exp": name, "solver": name, "reading": name})
    page = reproduction_page(made_up.model_copy(update={"rows": (row,)}), folder)
    assert "<b>" not in page


def test_control_characters_in_results_are_refused(made_up: Reproduction, tmp_path: Path) -> None:
    row = made_up.rows[0].model_copy(update={"exp": "a\x1b[31m"})
    text = to_json(made_up.model_copy(update={"rows": (row,)}))
    (tmp_path / "results.json").write_text(text)
    with pytest.raises(InputError, match=r"rows\.0\.exp: the text holds control characters"):
        read_reproduction(tmp_path)


@pytest.mark.parametrize("name", ["epochs", "seconds", "rmse_mm", "paper_abs_m"])
def test_figures_beyond_all_sense_are_refused(name: str, made_up: Reproduction, tmp_path: Path) -> None:
    row = made_up.rows[0].model_copy(update={name: 1e308})
    text = to_json(made_up.model_copy(update={"rows": (row,)}))
    (tmp_path / "results.json").write_text(text)
    with pytest.raises(InputError, match=rf"rows\.0\.{name}"):
        read_reproduction(tmp_path)
