"""``labcal diagnose``: what is wrong with a shoot, and how to mend it."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.options import add_page, add_target_and_cameras, add_workers, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "diagnose",
        run,
        "Name what is wrong with a shoot, the most harmful first: which cameras and views, what it costs in "
        "mm, how to mend it, and which pictures show it. Exit status: 0 nothing found; 1 something found; 2 "
        "wrong use, or no usable picture (what is wrong with them is said); 3 failed.",
        example="labcal diagnose shoot\n"
        "  labcal diagnose shoot --page diagnosis.html\n"
        "  labcal diagnose photos --target rings-10x8 --cameras '_0=left,_1=right'\n"
        "  labcal diagnose detections.csv --target rings-10x8 --json",
    )
    parser.add_argument(
        "pictures",
        nargs="+",
        metavar="SHOOT-or-IMAGES-or-TABLE",
        help="one shoot, or pictures and folders, or a table of dots, detections.csv, of which pictures are "
        "not judged",
    )
    add_target_and_cameras(parser)
    parser.add_argument(
        "--rig", type=Path, metavar="rig.json", help="a calibration of these cameras, which names their lens"
    )
    add_page(parser)
    parser.add_argument("--force", action="store_true", help="replace a page that labcal made")
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Diagnose, and report."""
    from labcal.cli.compiling import announce_compiling
    from labcal.cli.option_words import in_options
    from labcal.cli.page import asked_page
    from labcal.correspond.dot_source import is_dot_table
    from labcal.pipeline import diagnose, open_pictures
    from labcal.report.diagnose_result import diagnose_result, diagnose_words

    if arguments.page is None:
        refuse_option(arguments, "force", "replaces a page, and none is asked for")
    page = asked_page(arguments, session, [*arguments.pictures, arguments.rig])
    first = Path(arguments.pictures[0])
    if len(arguments.pictures) == 1 and is_dot_table(first):
        for name in ("workers", "cameras", "raw"):
            refuse_option(arguments, name, "is for pictures; a table holds their dots")
        found = diagnose(first, arguments.target, arguments.rig, page=page)
    else:
        pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
        for warning in pictures.warnings:
            session.warn(warning)
        announce_compiling(session)
        with session.progress() as progress:
            found = diagnose(
                pictures, arguments.target, arguments.rig, arguments.workers, progress, page=page
            )
    session.emit(diagnose_result(found), in_options(diagnose_words(found)))
    if not found.is_usable:
        return ExitStatus.UNUSABLE
    return ExitStatus.PARTIAL if found.findings else ExitStatus.DONE
