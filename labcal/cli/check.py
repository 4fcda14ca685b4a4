"""``labcal check``: whether a calibration is still valid."""

from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import add_detector_settings, add_page, add_pictures, add_workers, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.targets.catalogue import AnyTarget


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "check",
        run,
        "Check whether a calibration is still valid, by three or more new views of a target: which camera "
        "moved or was refocused, by how much, and what that costs in mm. Exit status: 0 valid; 1 changed; "
        "2 wrong use, or the pictures cannot tell; 3 failed.",
        example="labcal check rig.json shoot\n"
        "  labcal check rig.json photos --target rings-10x8 --cameras '_0=left,_1=right' --mend mended.json\n"
        "  labcal check rig.json detections.csv --target rings-10x8 --log checks.jsonl --page check.html",
    )
    parser.add_argument("rig", type=Path, metavar="RIG", help="from 'labcal calibrate'")
    add_pictures(parser)
    parser.add_argument(
        "--dots",
        type=Path,
        metavar="RIG-dots.json",
        help="in place of --target: the dots of this print, from 'labcal calibrate --free-dots', which find "
        "smaller changes",
    )
    parser.add_argument(
        "--mend",
        type=Path,
        metavar="OUT.json",
        help="write the corrected rig: relative pose, and focus if that changed; refused where these "
        "pictures do not support it",
    )
    parser.add_argument(
        "--log", type=Path, metavar="FILE.jsonl", help="add the check to a log, a line of JSON each"
    )
    parser.add_argument(
        "--date", metavar="DATE", help="of the check in the log, ISO 8601 (default: now, in UTC)"
    )
    parser.add_argument(
        "--temperature-c", type=float, metavar="C", help="temperature in the log, degrees Celsius"
    )
    parser.add_argument("--note", default="", metavar="TEXT", help="a note in the log")
    add_page(parser)
    parser.add_argument(
        "--force", action="store_true", help="replace a page or a corrected rig that labcal made"
    )
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Check, write what is asked for, report."""
    from labcal.cameras.rig_file import KIND
    from labcal.cli.page import asked_page
    from labcal.correspond.paths_read import paths_read
    from labcal.pipeline import CheckSettings, check
    from labcal.report.check_result import check_result, check_words
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.targets.places import read_places

    if arguments.dots is not None:
        refuse_option(arguments, "target", "is that of --dots, which names it")
    settings = CheckSettings(arguments.log, arguments.date, arguments.temperature_c, arguments.note)
    if arguments.page is None and arguments.mend is None:
        refuse_option(arguments, "force", "replaces a page or a corrected rig, and none is asked for")
    if arguments.mend is not None:
        read = paths_read([arguments.rig, *arguments.pictures, arguments.target, arguments.dots])
        claim_outputs([FileOutput(arguments.mend, KIND)], read, force=arguments.force)
    page = asked_page(arguments, session, [arguments.rig, *arguments.pictures])
    places = None if arguments.dots is None else read_places(arguments.dots)
    dots, target = _dots(arguments, session, None if places is None else places.target)
    found = check(arguments.rig, dots, places or target, settings, page=page)
    mended, refused = None, None
    if arguments.mend is not None:
        try:
            found.mended().save(arguments.mend, force=arguments.force)
            mended = arguments.mend
        except InputError as error:
            refused = str(error)
            session.warn(f"{arguments.mend} was not written: {error}")
    for warning in found.warnings:
        session.warn(warning)
    session.emit(check_result(found, mended, refused), check_words(found, mended))
    return {
        "valid": ExitStatus.DONE,
        "changed": ExitStatus.PARTIAL,
        "cannot-tell": ExitStatus.UNUSABLE,
    }[found.verdict.value]


def _dots(
    arguments: Namespace, session: Session, known: "AnyTarget | None"
) -> "tuple[Detections, AnyTarget]":
    """Return the dots of a table, or those found in pictures, and what they are of."""
    from labcal.cli.compiling import announce_compiling
    from labcal.correspond.detections_csv import read_detections
    from labcal.correspond.dot_source import dots_found
    from labcal.correspond.picture_set import target_shown
    from labcal.pipeline import detect_settings, measure_pictures, open_pictures
    from labcal.shoot.pictures import SUFFIXES

    first = Path(arguments.pictures[0])
    if len(arguments.pictures) == 1 and first.is_file() and first.suffix.lower() not in SUFFIXES:
        for name in ("workers", "cameras"):
            refuse_option(arguments, name, "is for pictures; a table holds their dots")
        if arguments.changes:
            raise InputError("--set is for finding dots in pictures; a table holds them. Leave it out.")
        return read_detections(first), known or target_shown(arguments.target, None)
    pictures = open_pictures(arguments.pictures, arguments.cameras)
    target, settings = known or pictures.target(arguments.target), detect_settings(arguments.changes)
    for warning in pictures.warnings:
        session.warn(warning)
    announce_compiling(session)
    with session.progress() as progress:
        measurements = measure_pictures(
            pictures, target, settings, workers=arguments.workers, progress=progress
        )
    detections, refused = dots_found(measurements)
    for words in refused:
        session.warn(words)
    return detections, target
