"""A shoot at a glance: exposure, sharpness and dots of every picture, drawn on one contact sheet."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from typing import TYPE_CHECKING

import numpy as np
from rich.table import Table

from labcal.correspond.coverage import coverage
from labcal.correspond.measure import Measurement, detections_of
from labcal.correspond.picture_set import PictureSet
from labcal.correspond.refused_pictures import shared_reasons
from labcal.extras import optional_module
from labcal.guide.picture_blur import usual_edges
from labcal.guide.picture_look import PictureLook, look_at
from labcal.paths import AnyPath, as_path
from labcal.public_object import HtmlTable, PublicObject
from labcal.report.columns import name_column
from labcal.report.contact_sheet import SheetCoverage, SheetLayout, SheetTile, contact_sheet, plan_layout
from labcal.report.marked_thumbnail import marked_thumbnail
from labcal.run.progress import Progress
from labcal.shoot.pictures import write_single_picture
from labcal.shoot.quality import picture_quality
from labcal.targets.catalogue import AnyTarget
from labcal.wording import counted

if TYPE_CHECKING:
    import pandas


@dataclass(frozen=True)
class InspectedPicture:
    """One picture."""

    image: str
    view: str
    camera: str
    role: str | None
    """``train`` or ``test``; null for a loose picture."""
    median_level: float | None
    """Share of full scale; null where the picture cannot be read, as the next two."""
    saturated_share: float | None
    """Share of pixels with a channel at full scale."""
    sharpness: float | None
    """Contrast of strong edges per pixel, 1/px (see ``labcal.shoot.quality``); null where there are none."""
    dots: int
    reason: str | None
    """Reason why the picture has no ids; null if it has."""
    doubt: str | None = None
    """The fault of exposure or sharpness where the target is, in words; null if there is none."""


@dataclass(frozen=True)
class InspectedCamera:
    """One camera."""

    coverage: float
    """Share of the cells of a grid of 8 x 6 over the picture that hold a dot in some view."""
    dots: int


@dataclass(frozen=True, eq=False, repr=False)
class Inspection(PublicObject):
    """Exposure and sharpness of pictures, and the parts of them in which dots were found.

    Attributes
    ----------
    pictures : tuple of InspectedPicture
    cameras : dict of str to InspectedCamera
        By name.
    sheet : array of uint8, shape (height, width, 3)
        The contact sheet, RGB.
    warnings : tuple of str
        Files that were left out, for people.
    name : str
        Of the shoot, or of the first folder or picture.
    tiles : tuple of SheetTile
        What the sheet shows of every picture.
    coverages : tuple of SheetCoverage
        What it shows of every camera.
    """

    pictures: tuple[InspectedPicture, ...]
    cameras: dict[str, InspectedCamera]
    sheet: np.ndarray
    warnings: tuple[str, ...] = ()
    name: str = ""
    tiles: tuple[SheetTile, ...] = field(default=(), compare=False)
    coverages: tuple[SheetCoverage, ...] = field(default=(), compare=False)

    def save(self, path: AnyPath, *, force: bool = False) -> None:
        """Write the contact sheet.

        Raises
        ------
        OutputError
            The picture may not be written.
        """
        write_single_picture(as_path(path), self.sheet, force=force)

    def to_pandas(self) -> "pandas.DataFrame":
        """Return a table with a line for each picture, and the columns of the JSON document.

        Raises
        ------
        DeviceError
            pandas is not installed.
        """
        names = [one.name for one in fields(InspectedPicture)]
        frame: pandas.DataFrame = optional_module("pandas", "data").DataFrame(
            {name: [getattr(picture, name) for picture in self.pictures] for name in names}
        )
        return frame

    def _summary(self) -> Mapping[str, object]:
        refused = sum(picture.reason is not None for picture in self.pictures)
        return {
            "pictures": len(self.pictures),
            "cameras": list(self.cameras),
            "dots": sum(picture.dots for picture in self.pictures),
            "refused": refused,
        }

    def _html_tables(self) -> Sequence[HtmlTable]:
        rows = [
            [one.view, one.camera, str(one.dots), "" if one.reason is None else one.reason]
            for one in self.pictures
        ]
        return [HtmlTable(("view", "camera", "dots", "refused because"), rows)]

    def document(self, sheet: AnyPath) -> "InspectResult":
        """Return the JSON document; `sheet` is where the contact sheet is."""
        return InspectResult(str(sheet), list(self.pictures), self.cameras)


@dataclass(frozen=True)
class InspectResult:
    """The JSON document of ``labcal inspect``."""

    sheet: str
    pictures: list[InspectedPicture]
    cameras: dict[str, InspectedCamera]


def inspection(
    pictures: PictureSet, measurements: Sequence[Measurement], target: AnyTarget, progress: Progress
) -> Inspection:
    """Return a shoot at a glance, from what was measured in its pictures.

    Raises
    ------
    InputError
        No picture could be read at all.
    """
    detections = detections_of(measurements)
    # Of cameras without a single dot, too.
    sizes = {found.source.camera: found.dots.size for found in measurements if found.dots is not None}
    sizes |= {name: detections.picture_size(name) for name in detections.cameras}
    aspect = max(height / width for width, height in sizes.values())
    layout = plan_layout(len(measurements), len(sizes), aspect)
    progress.start("drawing", len(measurements))
    inspected, tiles, looks = [], [], list[PictureLook | None]()
    for found in measurements:  # one picture in memory at a time
        picture, tile, look = _inspect(found, pictures.roles.get(found.source.view), target.count, layout)
        inspected.append(picture)
        tiles.append(tile)
        looks.append(look)
        progress.advance()
    inspected = _doubted(inspected, looks)
    coverages, cameras = [], {}
    for name, size in sizes.items():
        cells = coverage(detections, name, size)
        share = float((cells > 0).mean())
        cameras[name] = InspectedCamera(share, int(cells.sum()))
        title = f"{name}: dots in {share:.0%} of the picture, all views"
        coverages.append(SheetCoverage(title, size, cells))
    views = len({found.source.view for found in measurements})
    heading = f"{pictures.name}: {target.name}, {counted(views, 'view')}, {counted(len(tiles), 'picture')}"
    sheet = contact_sheet(heading, layout, tiles, coverages)
    return Inspection(
        tuple(inspected), cameras, sheet, pictures.warnings, pictures.name, tuple(tiles), tuple(coverages)
    )


def _inspect(
    found: Measurement, role: str | None, expected: int, layout: SheetLayout
) -> tuple[InspectedPicture, SheetTile, PictureLook | None]:
    """Return what there is to say of one picture, its tile, and its look."""
    source = found.source
    count = 0 if found.dots is None else int(found.dots.ok.sum())
    first = f"{source.view}  {source.camera}" + (f"  ({role})" if role else "")
    if found.dots is None:
        unread = InspectedPicture(
            source.image, source.view, source.camera, role, None, None, None, 0, found.reason
        )
        return unread, SheetTile(None, (first, found.reason or ""), refused=True), None
    picture = source.read()
    quality = picture_quality(picture)
    inspected = InspectedPicture(
        image=source.image,
        view=source.view,
        camera=source.camera,
        role=role,
        median_level=quality.median_level,
        saturated_share=quality.saturated_share,
        sharpness=quality.sharpness,
        dots=count,
        reason=found.reason,
    )
    exposure = f"median {quality.median_level:.0%}, at full scale {quality.saturated_share:.2%}"
    dots = f"{count} of {expected} dots, edges {quality.edge_width_px:.1f} px wide"
    last = dots if found.reason is None else found.reason
    thumbnail = marked_thumbnail(picture, found.dots, layout.box)
    tile = SheetTile(thumbnail, (first, exposure, last), refused=not found.indexed)
    return inspected, tile, look_at(picture, found.dots)


def _doubted(
    inspected: Sequence[InspectedPicture], looks: Sequence[PictureLook | None]
) -> list[InspectedPicture]:
    """Return the pictures with what is wrong with their exposure and sharpness."""
    of: dict[str, list[PictureLook]] = {}
    for picture, look in zip(inspected, looks, strict=True):
        if look is not None:
            of.setdefault(picture.camera, []).append(look)
    usual = usual_edges(of)
    doubted = []
    for picture, look in zip(inspected, looks, strict=True):
        doubt = None if look is None else look.exposure_words
        if look is not None and doubt is None and usual[picture.camera].is_blurred(look):
            doubt = usual[picture.camera].words(look)
        doubted.append(replace(picture, doubt=doubt))
    return doubted


def inspection_table(result: InspectResult, expected: int) -> Table:
    """Return the document for people; `expected` is how many dots the target has."""
    shared = shared_reasons([(one.image, one.reason) for one in result.pictures if one.reason is not None])
    words = [reason.words for reason in shared]
    cameras = "; ".join(f"{name}: {camera.coverage:.0%}" for name, camera in result.cameras.items())
    words += [f"{one.view} {one.camera}: {one.doubt}" for one in result.pictures if one.doubt is not None]
    caption = f"{result.sheet}\nshare of the picture where dots were found: {cameras}"
    table = Table(
        name_column("view"),
        name_column("camera"),
        "role",
        "median",
        "full\nscale",
        "sharpness\n(1/px)",
        "dots",
        caption="\n".join([*words, caption]),
        caption_justify="left",
    )
    for picture in result.pictures:
        exposure = ("-", "-", "-")
        if None not in (picture.median_level, picture.saturated_share, picture.sharpness):
            exposure = (
                f"{picture.median_level:.0%}",
                f"{picture.saturated_share:.2%}",
                f"{picture.sharpness:.3f}",
            )
        dots = f"{picture.dots} of {expected}" if picture.reason is None else "refused, see below"
        table.add_row(picture.view, picture.camera, picture.role or "-", *exposure, dots)
    return table
