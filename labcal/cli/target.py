"""``labcal target``: printable targets at exact scale."""

from argparse import Namespace
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.targets.grid import DotGrid

_NAME_HELP = "name of a target, or path of a YAML file"


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    target = commands.add_group(
        "target",
        "List, show and print targets of dots.",
        example="labcal target export rings-10x8 -o rings-10x8.pdf",
    )
    target.add("list", run_list, "List the targets that labcal ships.", example="labcal target list")
    show = target.add(
        "show", run_show, "Show the dimensions of a target.", example="labcal target show rings-10x8 --json"
    )
    show.add_argument("target", metavar="NAME", help=_NAME_HELP)


@dataclass(frozen=True)
class TargetList:
    """The JSON document of ``labcal target list``."""

    targets: "list[DotGrid]"


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the shipped targets."""
    from rich.table import Table

    from labcal.targets.catalogue import load_target, target_names

    targets = [load_target(name) for name in target_names()]
    table = Table("target", "dots", "pitch [mm]", "dot [mm]", "what it is")
    for grid in targets:
        pitch = f"{grid.pitch_x_mm:.6g} x {grid.pitch_y_mm:.6g}"
        dots = f"{grid.cols} x {grid.rows}"
        table.add_row(grid.name, dots, pitch, f"{grid.dot_diameter_mm:g}", grid.description)
    session.emit(TargetList(targets), table)
    return ExitStatus.DONE


def run_show(arguments: Namespace, session: Session) -> ExitStatus:
    """Show one target."""
    from rich.table import Table

    from labcal.targets.catalogue import load_target

    grid = load_target(arguments.target)
    table = Table("key", "value")
    for key, value in grid.model_dump(mode="json").items():
        shown = (
            ", ".join(f"{name} {place}" for name, place in value.items()) if key == "rings" else str(value)
        )
        table.add_row(key, shown)
    session.emit(grid, table)
    return ExitStatus.DONE
