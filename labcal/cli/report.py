"""``labcal report``: one page of a folder of results."""

from argparse import Namespace
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.wording import counted

if TYPE_CHECKING:
    from labcal.run.file_kinds import FileKind


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "report",
        run,
        "Make one self-contained HTML page of a folder of results. A page that labcal made is replaced: it "
        "can always be made again.",
        example="labcal report out/quick",
    )
    parser.add_argument(
        "folder",
        type=Path,
        metavar="DIR",
        help="the folder that 'labcal reproduce' or 'labcal bench distortion' made",
    )
    parser.add_argument("--force", action="store_true", help="replace a page that has been changed, too")


@dataclass(frozen=True)
class ReportResult:
    """The JSON document of ``labcal report``."""

    page: str
    missing_pictures: list[str]
    """Pictures that the results name and the page cannot show, relative to the folder."""


@dataclass(frozen=True)
class _MadePage:
    """A page before it is written."""

    text: str
    kind: "FileKind"
    summary: str
    missing_pictures: list[str] = field(default_factory=list)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Write ``index.html`` beside ``results.json``."""
    from labcal.report.reproduction import RESULTS
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.made import is_as_made, renew
    from labcal.run.outputs import write_file

    made = _page_of(arguments.folder)
    page = arguments.folder / "index.html"
    same = page.is_file() and page.read_bytes() == made.text.encode()
    force = arguments.force or is_as_made(page) or same
    claim_outputs([FileOutput(page, made.kind, arguments.folder)], [arguments.folder / RESULTS], force=force)
    write_file(page, made.text, force=force)
    renew(page)
    for file in made.missing_pictures:
        session.warn(f"The picture {file} cannot be shown on the page.")
    session.emit(ReportResult(str(page), made.missing_pictures), f"{page}: {made.summary}.")
    return ExitStatus.PARTIAL if made.missing_pictures else ExitStatus.DONE


def _page_of(folder: Path) -> _MadePage:
    """Return the page of a folder of results.

    Raises
    ------
    InputError
        It holds no results of which there is a page.
    """
    from labcal.report.bench import bench_of
    from labcal.report.reproduction import RESULTS, read_reproduction
    from labcal.report.reproduction_page import KIND, missing_pictures, reproduction_page

    bench = bench_of(folder / RESULTS)
    if bench is not None:
        return _bench_page(folder, bench)
    result = read_reproduction(folder)
    summary = counted(len(result.rows), "row")
    return _MadePage(reproduction_page(result, folder), KIND, summary, missing_pictures(result, folder))


def _bench_page(folder: Path, bench: str) -> _MadePage:
    from labcal.bench.distortion.kept_results import read_findings
    from labcal.bench.distortion.page.page import distortion_page
    from labcal.errors import InputError
    from labcal.report.page.document import PAGE_KIND
    from labcal.report.reproduction import RESULTS
    from labcal.run.file_kinds import recognised_by

    if bench != "distortion":
        figures = folder / RESULTS
        raise InputError(f"{folder} is of 'labcal bench {bench}', which has no page. See {figures}.")
    findings = read_findings(folder)
    # Of a page in a folder the mark of the folder has the digest, and not the page itself.
    kind = recognised_by("a page of 'labcal bench distortion'", PAGE_KIND.recognises)
    return _MadePage(distortion_page(findings).text(), kind, counted(findings.result.cases, "case"))
