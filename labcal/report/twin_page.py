"""The page of ``labcal twin``: what simulation explains, and every photograph beside its rendering."""

from pathlib import Path

from labcal.guide.twin.picture import DIFFERENCE, RENDERING
from labcal.report.page.document import Page, Section
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page.wiped import Wiped
from labcal.report.page_maker import PageMaker
from labcal.report.twin_result import TwinPictureResult, TwinResult
from labcal.report.twin_words import print_words, twin_summary
from labcal.shoot.pictures import read_picture
from labcal.shoot.raw_pictures import RawFormat, read_raw_picture
from labcal.wording import counted

_MOST_SHOWN = 24
_HOW = (
    "Each picture is rendered again with the calibrated lenses, the poses that suit them best, and the print "
    "as it is known. The light of paper and of ink, the blur of edges and the noise are measured in the "
    "photograph itself. Only the cells of dots that were measured are compared: floor, hands, the border of "
    "the sheet and what is printed beyond the grid are in no calibration."
)
_DIFFERENCE = (
    "photograph minus rendering in units of the noise: white is none, full red or blue is 5 standard "
    "deviations lighter or darker, grey was not compared"
)


def twin_page(result: TwinResult, folder: Path, maker: PageMaker, raw: RawFormat | None = None) -> Page:
    """Return the page of a twin.

    Parameters
    ----------
    result : TwinResult
    folder : Path
        Where the pictures of the twin are.
    maker : PageMaker
    raw : RawFormat, optional
        Pixel format of the photographs, where their files do not tell it.
    """
    opening: list[Part] = [
        Prose(tuple(words for words in (twin_summary(result), print_words(result)) if words))
    ]
    if not result.unexplained:
        opening.append(Prose(("Nothing beyond noise is found.",)))
    opening += maker.notes(result.warnings)
    shown = result.pictures[:_MOST_SHOWN]
    pictures: list[Part] = [_wiped(number, one, folder, raw) for number, one in enumerate(shown)]
    if len(shown) < len(result.pictures):
        pictures.append(
            Prose((f"The first {_MOST_SHOWN} are shown; the folder 'pictures' has all.",), Tone.QUIET)
        )
    return Page(
        title="Digital twin",
        heading="Photographs beside their renderings",
        lead=f"{counted(len(result.views), 'view')}, {counted(len(result.pictures), 'picture')}, "
        f"{counted(result.dots, 'dot')}.",
        sections=[
            Section("Not explained", [_unexplained(result), Prose((_HOW,), Tone.QUIET)]),
            Section("By picture", [_by_picture(result)]),
            Section("Pictures", pictures),
        ],
        provenance=maker.provenance,
        opening=opening,
    )


def _unexplained(result: TwinResult) -> PageTable:
    columns = [
        Column("share", meaning="of the squared residuals of dots"),
        Column("what", Side.WIDE),
        Column("pictures", Side.LEFT, meaning="that show it, where it is not all"),
    ]
    noise = [f"{100.0 * result.explained:.0f}%", "Noise, as simulated: this is explained", "all"]
    rows = [noise]
    for one in result.unexplained:
        share = MISSING if one.share is None else f"{100.0 * one.share:.0f}%"
        words = f"{one.words[:1].upper()}{one.words[1:]}"
        rows.append([share, words, ", ".join(one.pictures[:4]) or "all"])
    caption = (
        "What moves dots has a share of their squared residuals; what stands below it changes pictures alone."
    )
    return PageTable("unexplained", caption, columns, rows)


def _by_picture(result: TwinResult) -> PageTable:
    columns = [
        Column("picture", Side.LEFT), Column("dots"), Column("residual (px)", meaning="RMS, 2-D"),
        Column("by noise (px)", meaning="the same by simulated noise alone"),
        Column("blur (px)"),
        Column("paper and ink", meaning="mean squared difference of pixels over the variance of noise"),
        Column("edges", meaning="the same at the edges of dots"),
        Column("verdict", Side.WIDE),
    ]  # fmt: skip
    rows = [
        [
            f"{one.view} {one.camera}", str(one.dots), _number(one.rms_px), _number(one.noise_px),
            f"{one.blur_px:.2f}", _number(one.flat_variance), _number(one.edge_variance),
            "; ".join(one.findings) or "at noise level",
        ]
        for one in result.pictures
    ]  # fmt: skip
    return PageTable(
        "pictures-table", "1 is noise alone in the columns of squared differences.", columns, rows
    )


def _wiped(number: int, one: TwinPictureResult, folder: Path, raw: RawFormat | None) -> Wiped:
    name = f"{one.view}_{one.camera}.png"
    title = f"View {one.view}, camera {one.camera}"
    verdict = "; ".join(one.findings) or "at noise level"
    return Wiped(
        f"picture-{number}",
        read_picture(one.image) if raw is None else read_raw_picture(one.image, raw),
        read_picture(folder / RENDERING / name),
        read_picture(folder / DIFFERENCE / name),
        ("photograph", "rendering", _DIFFERENCE),
        f"{title}: {verdict}.",
    )


def _number(value: float | None) -> str:
    return MISSING if value is None else f"{value:.3g}"
