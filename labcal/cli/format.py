"""``labcal format``: the files of other systems that ``labcal convert`` reads and writes."""

from argparse import Namespace
from dataclasses import dataclass

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    formats = commands.add_group("format", "List the files of other systems.", example="labcal format list")
    formats.add(
        "list",
        run_list,
        "List the formats of 'labcal convert': their files, the unit of lengths and the lens models.",
        example="labcal format list --json",
    )


@dataclass(frozen=True)
class FormatEntry:
    """A format of cameras in the JSON document of ``labcal format list``."""

    format: str
    """As for ``--from`` and ``--to``."""
    suffixes: tuple[str, ...]
    """Endings of its files, the first of which is written."""
    folder: bool
    """True if the cameras are a folder of such files."""
    unit: str
    """Of lengths in them: mm or m."""
    options: tuple[str, ...]
    """Options of ``labcal convert`` that state what a file does not."""
    lenses: tuple[str, ...]
    """Lens models that are read and written, with all of their coefficients."""
    written: bool
    """False if its files are read and not written."""


@dataclass(frozen=True)
class PixelFormatEntry:
    """A format of named pixels in the same document."""

    format: str
    """As for ``--from``."""
    files: str
    options: tuple[str, ...]
    """Options of ``labcal convert`` that it takes."""


@dataclass(frozen=True)
class FormatList:
    """The JSON document of ``labcal format list``."""

    formats: list[FormatEntry]
    detections: tuple[str, ...]
    """Files of dots, which are converted into each other."""
    pixels: list[PixelFormatEntry]
    """Tables of named pixels, from which ``labcal convert --from NAME`` makes a pixels.csv."""


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the formats."""
    from rich.table import Table

    from labcal.cameras.interop.exchange import Home
    from labcal.cameras.interop.held_lenses import held_lenses
    from labcal.cameras.interop.registry import FORMATS, READ
    from labcal.correspond.interop.pixels.registry import PIXEL_FORMATS

    entries = [
        FormatEntry(
            format=name,
            suffixes=one.suffixes,
            folder=one.home is Home.FOLDER,
            unit=one.unit.value,
            options=tuple(f"--{option}" for option in one.options),
            lenses=held_lenses(one),
            written=name in FORMATS,
        )
        for name, one in READ.items()
    ]
    dots = ("detections.csv", "corners.vnl")
    table = Table(
        "format",
        "files",
        "unit",
        "lens models that are read and written",
        "what may be stated",
        caption="A lens model is one with all of its coefficients; more is read, and all that is refused is "
        f"named: docs/reference/formats.md. Detections: {' from and to '.join(dots)} of mrcal and mrgingham. "
        f"Tables of pixels, which become a pixels.csv: {', '.join(PIXEL_FORMATS)}.",
        caption_justify="left",
    )
    table.columns[0].no_wrap = True
    for entry in entries:
        files = f"a folder of {' '.join(entry.suffixes)}" if entry.folder else " ".join(entry.suffixes)
        options = " ".join(entry.options)
        lenses = ", ".join(entry.lenses) if entry.written else "read, not written"
        table.add_row(entry.format, files, entry.unit, lenses, options)
    pixels = [
        PixelFormatEntry(name, one.files, tuple(f"--{option}" for option in one.options))
        for name, one in PIXEL_FORMATS.items()
    ]
    session.emit(FormatList(entries, dots, pixels), table)
    return ExitStatus.DONE
