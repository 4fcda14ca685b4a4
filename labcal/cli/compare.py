"""``labcal compare``: the difference of two calibrations."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.options import refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "compare",
        run,
        "Compare two calibrations of the same cameras: over their pictures and over the volume where the "
        "target was, beside what the errors of both would explain. Frames of calibrations differ by a motion "
        "that no measurement tells; it is removed first.",
        example="labcal compare monday.json friday.json -o comparison.html\n"
        "  labcal compare a.json b.json --cameras left=cam0,right=cam1 --pictures different",
    )
    parser.add_argument("one", type=Path, metavar="RIG", help="from 'labcal calibrate' or 'labcal convert'")
    parser.add_argument("other", type=Path, metavar="RIG", help="another one, of the same cameras")
    parser.add_argument(
        "-o",
        "--output",
        "--page",
        dest="page",
        type=Path,
        metavar="FILE.html",
        help="write a page: maps of the differences and of both budgets; it fetches nothing",
    )
    parser.add_argument("--force", action="store_true", help="replace a page that labcal made")
    parser.add_argument(
        "--cameras",
        metavar="NAMES",
        help="names in the second rig by those in the first where they differ: left=cam0,right=cam1",
    )
    parser.add_argument(
        "--distances-mm",
        metavar="MM[,MM]",
        help="distances from the cameras at which lenses are compared, beside infinity (where not given: "
        "the target's, which the rig states)",
    )
    parser.add_argument(
        "--pictures",
        choices=["different", "same"],
        help="whether the calibrations come from the same pictures; only the errors of different ones are "
        "independent, so that they can be tested (where not given: told by the names of views)",
    )


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Compare and report."""
    from labcal.cli.numbers import numbers
    from labcal.cli.page import asked_page
    from labcal.evaluate.comparison.compare_settings import parse_names
    from labcal.pipeline import CompareSettings, compare
    from labcal.report.compare_result import compare_result, comparison_table

    if arguments.page is None:
        refuse_option(arguments, "force", "replaces a page, and none is asked for")
    page = asked_page(arguments, session, [arguments.one, arguments.other])
    settings = CompareSettings(
        cameras=None if arguments.cameras is None else parse_names(arguments.cameras),
        distances_mm=numbers(arguments.distances_mm, "distances_mm"),
        pictures=arguments.pictures,
    )
    found = compare(arguments.one, arguments.other, settings, page=page)
    for warning in found.warnings:
        session.warn(warning)
    session.emit(compare_result(found), comparison_table(found))
    missing = found.volume is None and len(found.cameras) > 1
    return ExitStatus.PARTIAL if missing else ExitStatus.DONE
