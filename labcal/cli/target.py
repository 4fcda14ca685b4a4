"""``labcal target``: printable targets at exact scale."""

import re
from argparse import Namespace
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.cli.options import add_output, positive_number, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.cli.target_make import add_make, counts_of
from labcal.errors import InputError
from labcal.wording import listed

if TYPE_CHECKING:
    from labcal.targets.catalogue import AnyTarget
    from labcal.targets.paper import Paper

_NAME_HELP = "name of a target, or path of a YAML file"


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    target = commands.add_group(
        "target",
        "List, show, design and print targets of dots.",
        example="labcal target export rings-10x8 -o rings-10x8.pdf",
    )
    target.add(
        "list",
        run_list,
        "List the targets that labcal ships, and the kinds of targets.",
        example="labcal target list",
    )
    show = target.add(
        "show", run_show, "Show the dimensions of a target.", example="labcal target show rings-10x8 --json"
    )
    show.add_argument("target", metavar="NAME", help=_NAME_HELP)
    add_make(target)
    export = target.add(
        "export",
        run_export,
        "Write a target as a file to print at exact scale, with a ruler to check the print by, and a code "
        "that tells 'detect', 'calibrate' and 'capture' which target it is.",
        example="labcal target export rings-10x8 -o rings-10x8.pdf",
    )
    export.add_argument("target", metavar="NAME", help=_NAME_HELP)
    add_output(export, "FILE.{svg,pdf,png}", "the file; its ending determines the format")
    export.add_argument(
        "--dpi", type=positive_number, metavar="N", help="pixels an inch of a PNG (300 where not given)"
    )
    export.add_argument(
        "--paper",
        metavar="NAME",
        help="write a PDF of pages of this paper (a4, letter, a3, ... or 300x200 mm): one if the sheet fits, "
        "else tiles that overlap, to be cut and joined",
    )
    export.add_argument(
        "--tiles",
        metavar="CxR",
        help="with --paper: at most so many pages side by side and one above the other; 1x1 refuses a sheet "
        "that does not fit on one page",
    )
    export.add_argument(
        "--copy",
        type=positive_number,
        metavar="N",
        help="number of the print, in its code: tells several prints of one target apart; its name is NAME#N",
    )
    export.add_argument(
        "--plain", action="store_true", help="print no code, as before: commands then need --target NAME"
    )


@dataclass(frozen=True)
class TargetList:
    """The JSON document of ``labcal target list``."""

    targets: "list[AnyTarget]"
    kinds: tuple[str, ...]
    """Of which a description can be; without the key `kind` it is of the first one."""
    papers: dict[str, str | None]
    """The smallest paper that each target's sheet fits; null where it fits none."""


@dataclass(frozen=True)
class ExportedTarget:
    """The JSON document of ``labcal target export``."""

    target: str
    file: str
    width_mm: float
    height_mm: float
    dpi: int | None
    paper: str | None
    """The paper of the pages; without `--paper` the smallest one that the sheet fits."""
    fits_a4: bool
    """True if a single sheet of A4 holds it."""
    pages: int
    tiles: tuple[int, int]
    """Pages side by side, and one above the other."""
    code: str | None
    """Text of the QR code on the print; null on a plain one, and of a kind of a user's."""
    copy: int | None
    """Number of the print; null where it has none."""


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the shipped targets."""
    from rich.table import Table

    from labcal.report.columns import name_column
    from labcal.targets.catalogue import load_target, target_names
    from labcal.targets.paper import smallest_paper
    from labcal.targets.registry import PLAIN, kind_of, target_kinds

    targets = [load_target(name) for name in target_names()]
    kinds = target_kinds()
    papers = {target.name: smallest_paper(target) for target in targets}
    table = Table(name_column("target"), "dots", "pitch, dot (mm)", "paper", "what it is")
    table.caption = f"Kinds that a description can be of: {listed(kinds)}"
    for target in targets:
        kind = kind_of(target).name
        table.add_row(
            target.name,
            f"{target.cols} x {target.rows}" + ("" if kind == PLAIN else f" {kind}"),
            _sizes(*target.sizes),
            _paper_name(papers[target.name]) or "none",
            re.split(r"[,;:.](?:\s|$)", target.description)[0],
        )
    names = {name: _paper_name(paper) for name, paper in papers.items()}
    session.emit(TargetList(targets, kinds, names), table)
    return ExitStatus.DONE


def run_show(arguments: Namespace, session: Session) -> ExitStatus:
    """Show one target."""
    from rich.table import Table

    from labcal.targets.catalogue import load_target
    from labcal.targets.paper import smallest_paper

    target = load_target(arguments.target)
    table = Table("key", "value")
    for key, value in target.model_dump(mode="json").items():
        parts = value.items() if isinstance(value, dict) else ()
        shown = ", ".join(f"{name} {place}" for name, place in parts) or (
            "none" if value is None else str(value)
        )
        table.add_row(key, shown)
    paper = smallest_paper(target)
    table.caption = f"The smallest paper for it: {'none up to A0' if paper is None else paper.sides}"
    session.emit(target, table)
    return ExitStatus.DONE


def run_export(arguments: Namespace, session: Session) -> ExitStatus:
    """Write a target as a file to print."""
    from labcal.run.claims import claim_outputs
    from labcal.targets.artwork import artwork_output, export_artwork, print_text
    from labcal.targets.catalogue import load_target
    from labcal.targets.page_artwork import PageSettings, export_pages
    from labcal.targets.paper import PAPERS, paper_of, sheet_size, smallest_paper

    target = load_target(arguments.target)
    claim_outputs([artwork_output(arguments.output)], [arguments.target], force=arguments.force)
    if arguments.plain:
        refuse_option(arguments, "copy", "is a number in the code, which a plain print does not have")
    copy = None if arguments.plain else arguments.copy or 0
    width, height = sheet_size(target, copy)
    fits_a4 = PAPERS["a4"].holds(width, height)
    smallest = smallest_paper(target, copy)
    if arguments.paper is None:
        if arguments.tiles is not None:
            raise InputError("Tiles are pages of a paper: give `paper`, too, or leave `tiles` out.")
        artwork = export_artwork(
            target, arguments.output, dpi=arguments.dpi, force=arguments.force, copy=copy
        )
        width, height, dpi = artwork.width_mm, artwork.height_mm, artwork.dpi
        paper, tiles = _paper_name(smallest), (1, 1)
        if not fits_a4:
            session.warn(_too_large(width, height, smallest))
    else:
        if arguments.dpi is not None:
            raise InputError("Pages of a paper are written as PDF, which has no pixels: leave `dpi` out.")
        counts = None if arguments.tiles is None else counts_of(arguments.tiles, "--tiles")
        sheet = paper_of(arguments.paper)
        paper, dpi = sheet.name, None
        tiles = export_pages(
            target, arguments.output, PageSettings(sheet, counts), copy=copy, force=arguments.force
        ).counts
    result = ExportedTarget(
        target=target.name,
        file=str(arguments.output),
        width_mm=width,
        height_mm=height,
        dpi=dpi,
        paper=paper,
        fits_a4=fits_a4,
        pages=tiles[0] * tiles[1],
        tiles=tiles,
        code=print_text(target, copy),
        copy=arguments.copy,
    )
    size = f"{width:.1f} mm x {height:.1f} mm"
    pages = "" if result.pages == 1 else f" on {tiles[0]} x {tiles[1]} pages of {paper}"
    session.emit(result, f"{arguments.output}: {size}{pages}. Print at 100 % and check the ruler.")
    return ExitStatus.DONE


def _sizes(pitches: str, dot: str) -> str:
    """Return pitch and size of a dot in words, one number where both pitches are alike."""
    across, _, up = pitches.partition(" x ")
    return f"{across if across == up else pitches}, {dot}"


def _paper_name(paper: "Paper | None") -> str | None:
    """Return the name of a paper, if there is one."""
    return None if paper is None else paper.name


def _too_large(width_mm: float, height_mm: float, smallest: "Paper | None") -> str:
    """Return what to do with a sheet that A4 does not hold."""
    size = f"{width_mm:.0f} mm x {height_mm:.0f} mm"
    needed = "paper larger than A0" if smallest is None else smallest.sides
    return (
        f"the sheet of {size} does not fit on A4: it needs {needed}. Give `paper` a4 to write tiles to be "
        "joined."
    )
