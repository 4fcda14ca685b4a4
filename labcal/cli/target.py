"""``labcal target``: printable targets at exact scale."""

from argparse import Namespace
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.cli.options import add_output, positive_number, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.wording import listed

if TYPE_CHECKING:
    from labcal.targets.catalogue import AnyTarget

_NAME_HELP = "name of a target, or path of a YAML file"


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    target = commands.add_group(
        "target",
        "List, show and print targets of dots.",
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


@dataclass(frozen=True)
class ExportedTarget:
    """The JSON document of ``labcal target export``."""

    target: str
    file: str
    width_mm: float
    height_mm: float
    dpi: int | None
    code: str | None
    """Text of the QR code on the print; null on a plain one, and of a kind of a user's."""
    copy: int | None
    """Number of the print; null where it has none."""


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the shipped targets."""
    from rich.table import Table

    from labcal.report.columns import name_column
    from labcal.targets.catalogue import load_target, target_names
    from labcal.targets.registry import kind_of, target_kinds

    targets = [load_target(name) for name in target_names()]
    kinds = target_kinds()
    table = Table(name_column("target"), "kind", "dots", "pitch [mm]", "dot [mm]", "what it is")
    table.caption = f"Kinds that a description can be of: {listed(kinds)}"
    for target in targets:
        count = f"{target.cols} x {target.rows}"
        table.add_row(target.name, kind_of(target).name, count, *target.sizes, target.description)
    session.emit(TargetList(targets, kinds), table)
    return ExitStatus.DONE


def run_show(arguments: Namespace, session: Session) -> ExitStatus:
    """Show one target."""
    from rich.table import Table

    from labcal.targets.catalogue import load_target

    target = load_target(arguments.target)
    table = Table("key", "value")
    for key, value in target.model_dump(mode="json").items():
        parts = value.items() if isinstance(value, dict) else ()
        shown = ", ".join(f"{name} {place}" for name, place in parts) or (
            "none" if value is None else str(value)
        )
        table.add_row(key, shown)
    session.emit(target, table)
    return ExitStatus.DONE


def run_export(arguments: Namespace, session: Session) -> ExitStatus:
    """Write a target as a file to print."""
    from labcal.run.claims import claim_outputs
    from labcal.targets.artwork import artwork_output, export_artwork
    from labcal.targets.catalogue import load_target

    target = load_target(arguments.target)
    claim_outputs([artwork_output(arguments.output)], [arguments.target], force=arguments.force)
    if arguments.plain:
        refuse_option(arguments, "copy", "is a number in the code, which a plain print does not have")
    copy = None if arguments.plain else arguments.copy or 0
    artwork = export_artwork(target, arguments.output, dpi=arguments.dpi, force=arguments.force, copy=copy)
    result = ExportedTarget(
        target=target.name,
        file=str(arguments.output),
        width_mm=artwork.width_mm,
        height_mm=artwork.height_mm,
        dpi=artwork.dpi,
        code=artwork.code,
        copy=arguments.copy,
    )
    size = f"{artwork.width_mm:.1f} mm x {artwork.height_mm:.1f} mm"
    session.emit(result, f"{arguments.output}: {size}. Print at 100 % and check the ruler.")
    return ExitStatus.DONE
