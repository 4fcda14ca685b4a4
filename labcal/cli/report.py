"""``labcal report``: one page of a folder of results."""

from argparse import Namespace
from dataclasses import dataclass
from pathlib import Path

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.wording import counted


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "report",
        run,
        "Make one self-contained HTML page of a folder of results. A page that labcal made is replaced: it "
        "can always be made again.",
        example="labcal report out/quick",
    )
    parser.add_argument("folder", type=Path, metavar="DIR", help="the folder that 'labcal reproduce' made")
    parser.add_argument("--force", action="store_true", help="replace a page that has been changed, too")


@dataclass(frozen=True)
class ReportResult:
    """The JSON document of ``labcal report``."""

    page: str
    missing_pictures: list[str]
    """Pictures that the results name and the page cannot show, relative to the folder."""


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Write ``index.html`` beside ``results.json``."""
    from labcal.report.reproduction import RESULTS, read_reproduction
    from labcal.report.reproduction_page import KIND, missing_pictures, reproduction_page
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.made import is_as_made, renew
    from labcal.run.outputs import write_file

    result = read_reproduction(arguments.folder)
    page = arguments.folder / "index.html"
    text = reproduction_page(result, arguments.folder)
    same = page.is_file() and page.read_bytes() == text.encode()
    force = arguments.force or is_as_made(page) or same
    claim_outputs([FileOutput(page, KIND, arguments.folder)], [arguments.folder / RESULTS], force=force)
    write_file(page, text, force=force)
    renew(page)
    missing = missing_pictures(result, arguments.folder)
    for file in missing:
        session.warn(f"The picture {file} cannot be shown on the page.")
    session.emit(ReportResult(str(page), missing), f"{page}: {counted(len(result.rows), 'row')}.")
    return ExitStatus.PARTIAL if missing else ExitStatus.DONE
