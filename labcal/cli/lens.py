"""``labcal lens``: the lens models that calibrations, scenes and files can have."""

from argparse import Namespace
from dataclasses import dataclass

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    lens = commands.add_group("lens", "List the lens models.", example="labcal lens list")
    lens.add(
        "list",
        run_list,
        "List the lens models, their coefficients, and the files of other systems that hold them.",
        example="labcal lens list --json",
    )


@dataclass(frozen=True)
class LensEntry:
    """A lens model in the JSON document of ``labcal lens list``."""

    lens: str
    coefficients: tuple[str, ...]
    """Their names, in the order of ``dist``."""
    opencv: str | None
    """The function of OpenCV that has the same coefficients; null where it has none."""
    rectilinear: bool
    """True if straight lines stay straight without distortion, so that it sees less than 180 degrees."""
    central: bool
    """True if all rays pass one point."""
    formats: tuple[str, ...]
    """Formats of ``labcal convert`` that hold it."""


@dataclass(frozen=True)
class LensList:
    """The JSON document of ``labcal lens list``."""

    lenses: list[LensEntry]
    prescriptions: list[str]
    """Lenses of glass that labcal ships, whose surfaces are known and traced one by one."""


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the lens models."""
    from rich.table import Table

    from labcal.cameras.interop.held_lenses import holding_formats
    from labcal.cameras.lens import LENSES
    from labcal.cameras.prescription import prescription_names

    entries = [
        LensEntry(
            lens=name,
            coefficients=tuple(lens.names),
            opencv=None if lens.opencv is None else lens.opencv.function,
            rectilinear=lens.rectilinear,
            central=lens.central,
            formats=holding_formats(name),
        )
        for name, lens in LENSES.items()
    ]
    glass = prescription_names()
    table = Table(
        "lens",
        "coefficients",
        "files that hold it",
        caption=f"Of glass, by its surfaces: {', '.join(glass)}, or a YAML file of your own; for scenes and "
        "'labcal fit', held by labcal's files only. A format holds a lens with all of its coefficients.",
        caption_justify="left",
    )
    table.columns[0].no_wrap = True
    for entry in entries:
        table.add_row(entry.lens, " ".join(entry.coefficients) or "none", ", ".join(entry.formats))
    session.emit(LensList(entries, glass), table)
    return ExitStatus.DONE
