"""The page of ``labcal inspect``: every picture with its dots, exposure and sharpness, and the coverage."""

import base64
from collections.abc import Sequence

import cv2
import numpy as np
from jaxtyping import UInt8

from labcal.correspond.refused_pictures import shared_reasons
from labcal.report.contact_sheet import SheetCoverage, SheetTile
from labcal.report.inspection import InspectedPicture, Inspection
from labcal.report.page.document import Page, Section
from labcal.report.page.download import Download
from labcal.report.page.part import Part
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.table import MISSING, Column, PageTable, Side
from labcal.report.page.written import Written
from labcal.report.page_maker import PageMaker
from labcal.run.tables import table_text
from labcal.wording import counted, listed

_JPEG_QUALITY = 72
_MOST_PIXELS = 1.2e7
"""Of all pictures together, so that the page stays below 10 MB."""
_WORTH_WORDS = 8
"""Pictures of which the page says at its top what is wrong; the table says it of all."""
_COVERED = 0.4
"""Share of a camera's picture with dots, below which most of its lens is not seen."""


def inspection_page(found: Inspection, maker: PageMaker) -> Page:
    """Return a shoot at a glance as a page.

    Parameters
    ----------
    found : Inspection
        With its tiles.
    maker : PageMaker
    """
    refused = [one for one in found.pictures if one.reason is not None]
    good = len(found.pictures) - len(refused)
    summary = (
        f"{good} of {counted(len(found.pictures), 'picture')} can be used, with "
        f"{counted(sum(one.dots for one in found.pictures), 'dot')}."
    )
    sections = [
        Section("Coverage", [Prose((_COVERAGE,)), _coverage_part(found.coverages)]),
        Section("Pictures", [Prose((_TILES,)), _tiles_part(found.tiles)]),
        Section("Figures", [_table(found.pictures)]),
    ]
    return Page(
        title="Pictures at a glance",
        heading=f"Pictures at a glance: {found.name}",
        lead=summary,
        sections=sections,
        provenance=maker.provenance,
        opening=[*maker.notes([*found.warnings, *_remarks(found)]), *_refused(refused)],
    )


_COVERAGE = (
    "Dots in each part of the picture, over all views. A lens is not known where no dot was: fill the white "
    "cells, above all the corners."
)
_TILES = "Measured dots are green, and red is at full scale. A red frame means that the picture is refused."


def _remarks(found: Inspection) -> list[str]:
    """Return what is worth a word, by the limits of this file."""
    remarks = [f"{_named(one)}: {one.doubt}." for one in found.pictures if one.doubt is not None][
        :_WORTH_WORDS
    ]
    coverages = {name: camera.coverage for name, camera in found.cameras.items()}
    bare = [f"{name} ({share:.0%})" for name, share in coverages.items() if share < _COVERED]
    if bare:
        remarks.append(
            f"dots cover little of the picture of {listed(bare)}. Take views with dots up to the corners."
        )
    return remarks


def _named(one: InspectedPicture) -> str:
    return f"{one.view} {one.camera}"


def _refused(refused: Sequence[InspectedPicture]) -> list[Part]:
    """Return why pictures are refused."""
    shared = shared_reasons([(one.image, one.reason) for one in refused if one.reason is not None])
    return [Prose((reason.words,), Tone.NOTE) for reason in shared]


def _coverage_part(coverages: Sequence[SheetCoverage]) -> Part:
    """Return the coverage of each camera's picture as a grid of cells."""
    shown = []
    for one in coverages:
        most = max(int(one.cells.max()), 1)
        cells = [
            {"count": count, "share": round(100 * (0.15 + 0.85 * count / most)) if count else 0}
            for count in one.cells.ravel().tolist()
        ]
        shown.append({"title": one.title, "cells": cells, "columns": one.cells.shape[1], "size": one.size})
    return Written("coverage.html.jinja", {"cameras": shown})


def _tiles_part(tiles: Sequence[SheetTile]) -> Part:
    """Return every picture, small."""
    pixels = sum(
        tile.thumbnail.shape[0] * tile.thumbnail.shape[1] for tile in tiles if tile.thumbnail is not None
    )
    smaller = min(1.0, (_MOST_PIXELS / max(pixels, 1)) ** 0.5)
    shown = []
    for tile in tiles:
        data, size = ("", (0, 0)) if tile.thumbnail is None else _jpeg(tile.thumbnail, smaller)
        shown.append({"lines": tile.lines, "refused": tile.refused, "data": data, "size": size})
    return Written("tiles.html.jinja", {"tiles": shown})


def _jpeg(picture: UInt8[np.ndarray, "h w 3"], scale: float) -> tuple[str, tuple[int, int]]:
    """Return a picture, scaled, as a JPEG in base64, and its width and height, px."""
    if scale < 1.0:
        size = [max(1, round(scale * side)) for side in picture.shape[1::-1]]
        picture = np.asarray(cv2.resize(picture, size, interpolation=cv2.INTER_AREA))
    _, data = cv2.imencode(".jpg", picture[..., ::-1], [cv2.IMWRITE_JPEG_QUALITY, _JPEG_QUALITY])
    height, width = picture.shape[:2]
    return base64.b64encode(data.tobytes()).decode(), (width, height)


def _table(pictures: Sequence[InspectedPicture]) -> PageTable:
    columns = [
        Column("view", Side.LEFT),
        Column("camera", Side.LEFT),
        Column("role", Side.LEFT),
        Column("median", meaning="Median grey value, share of full scale"),
        Column("at full scale", meaning="Share of pixels"),
        Column("sharpness, 1/px", meaning="Contrast of strong edges per pixel"),
        Column("dots"),
        Column("doubt", Side.WIDE),
        Column("refused because", Side.WIDE),
    ]
    rows = [
        [
            one.view,
            one.camera,
            one.role or MISSING,
            MISSING if one.median_level is None else f"{one.median_level:.0%}",
            MISSING if one.saturated_share is None else f"{one.saturated_share:.2%}",
            MISSING if one.sharpness is None else f"{one.sharpness:.3f}",
            str(one.dots),
            one.doubt or "",
            one.reason or "",
        ]
        for one in pictures
    ]
    header = (
        "image",
        "view",
        "camera",
        "role",
        "median_level",
        "saturated_share",
        "sharpness",
        "dots",
        "doubt",
        "reason",
    )
    lines = [[getattr(one, name) for name in header] for one in pictures]
    data = Download("pictures.csv", table_text(header, lines))
    return PageTable("pictures-table", "Exposure, sharpness and dots of every picture.", columns, rows, data)
