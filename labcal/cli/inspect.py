"""``labcal inspect``: a contact sheet of a shoot."""

import os.path
from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.inputs import paths_read, pictures_and_target, say_whether_compiling
from labcal.cli.options import add_output, add_pictures, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.correspond.measure import Measurement
    from labcal.report.contact_sheet import SheetLayout, SheetTile


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "inspect",
        run,
        "Draw a contact sheet: exposure, sharpness and dots of every picture, and where in each camera's "
        "picture dots were found.",
        example="labcal inspect shoot -o sheet.png",
    )
    add_pictures(parser)
    add_output(parser, "sheet.png", "picture to write")
    add_workers(parser)


@dataclass(frozen=True)
class InspectedPicture:
    """One picture in the JSON document of ``labcal inspect``."""

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
    """Why the picture has no ids; null where it has."""


@dataclass(frozen=True)
class InspectedCamera:
    """One camera in the JSON document of ``labcal inspect``."""

    coverage: float
    """Share of the cells of a grid of 8 x 6 over the picture that hold a dot in some view."""
    dots: int


@dataclass(frozen=True)
class InspectResult:
    """The JSON document of ``labcal inspect``."""

    sheet: str
    pictures: list[InspectedPicture]
    cameras: dict[str, InspectedCamera]


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure, draw the sheet, tell."""
    from labcal.correspond.coverage import coverage
    from labcal.correspond.measure import detections_of
    from labcal.pipeline import measure
    from labcal.report.contact_sheet import SheetCoverage, contact_sheet, plan_layout
    from labcal.run.claims import claim_outputs
    from labcal.shoot.pictures import picture_output, write_single_picture
    from labcal.wording import counted

    sources, target = pictures_and_target(arguments, session)
    read = paths_read([*arguments.pictures, arguments.target], sources)
    claim_outputs([picture_output(arguments.output)], read, force=arguments.force)
    roles = _roles(arguments.pictures)
    say_whether_compiling(session)
    with session.progress() as progress:
        measurements = measure(sources, target, arguments.workers, progress)
        detections = detections_of(measurements)
        # Of cameras without a single dot, too.
        sizes = {found.source.camera: found.dots.size for found in measurements if found.dots is not None}
        sizes |= {name: detections.picture_size(name) for name in detections.cameras}
        aspect = max(height / width for width, height in sizes.values())
        layout = plan_layout(len(measurements), len(sizes), aspect)
        progress.start("drawing", len(measurements))
        pictures, tiles = [], []
        for found in measurements:  # one picture in memory at a time
            picture, tile = _inspect(found, roles.get(found.source.view), target.count, layout)
            pictures.append(picture)
            tiles.append(tile)
            progress.advance()
    coverages, cameras = [], {}
    for name, size in sizes.items():
        cells = coverage(detections, name, size)
        share = float((cells > 0).mean())
        cameras[name] = InspectedCamera(share, int(cells.sum()))
        title = f"{name}: dots in {share:.0%} of the picture, all views"
        coverages.append(SheetCoverage(title, size, cells))
    views = len({found.source.view for found in measurements})
    place = Path(os.path.realpath(arguments.pictures[0])).name  # of a loop of links, too
    heading = f"{place}: {target.name}, {counted(views, 'view')}, {counted(len(tiles), 'picture')}"
    sheet = contact_sheet(heading, layout, tiles, coverages)
    write_single_picture(arguments.output, sheet, force=arguments.force)
    result = InspectResult(str(arguments.output), pictures, cameras)
    session.emit(result, _table(result, target.count))
    refused = any(picture.reason is not None for picture in pictures)
    return ExitStatus.PARTIAL if refused else ExitStatus.DONE


def _roles(pictures: list[str]) -> dict[str, str]:
    """Return what each view of a shoot is for; nothing for loose pictures."""
    from labcal.shoot.dataset import is_shoot, open_shoot

    if len(pictures) != 1 or not is_shoot(Path(pictures[0])):
        return {}
    return {view.name: view.role.value for view in open_shoot(Path(pictures[0])).views()}


def _inspect(
    found: "Measurement", role: str | None, expected: int, layout: "SheetLayout"
) -> "tuple[InspectedPicture, SheetTile]":
    """Return what there is to say of one picture, and its tile."""
    from labcal.report.contact_sheet import SheetTile
    from labcal.report.marked_thumbnail import marked_thumbnail
    from labcal.shoot.quality import picture_quality

    source = found.source
    count = 0 if found.dots is None else int(found.dots.ok.sum())
    first = f"{source.view}  {source.camera}" + (f"  ({role})" if role else "")
    if found.dots is None:
        unread = InspectedPicture(
            source.image, source.view, source.camera, role, None, None, None, 0, found.reason
        )
        return unread, SheetTile(None, (first, found.reason or ""), refused=True)
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
    return inspected, SheetTile(thumbnail, (first, exposure, last), refused=not found.indexed)


def _table(result: InspectResult, expected: int) -> object:
    from rich.table import Table

    from labcal.cli.console import name_column
    from labcal.correspond.refused_pictures import shared_reasons

    shared = shared_reasons([(one.image, one.reason) for one in result.pictures if one.reason is not None])
    told = [reason.words for reason in shared]
    cameras = "; ".join(f"{name}: {camera.coverage:.0%}" for name, camera in result.cameras.items())
    caption = f"{result.sheet}\nshare of the picture where dots were found: {cameras}"
    table = Table(
        name_column("view"),
        name_column("camera"),
        "role",
        "median",
        "full scale",
        "sharpness, 1/px",
        "dots",
        caption="\n".join([*told, caption]),
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
