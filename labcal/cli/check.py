"""``labcal check``: whether a calibration is still valid."""

from argparse import Namespace
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import (
    add_cameras,
    add_detector_settings,
    add_page,
    add_targets,
    add_workers,
    refuse_option,
)
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError
from labcal.run.decimal_words import decimal

if TYPE_CHECKING:
    from labcal.correspond.detections import Detections
    from labcal.correspond.named_pixels import NamedPixels
    from labcal.guide.check_settings import CheckSettings
    from labcal.reconstruct.found_marks import FoundMarks
    from labcal.targets.catalogue import AnyTarget


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "check",
        run,
        "Check whether a calibration is still valid, by three or more new views of a target, or by marks "
        "that stay where they are: which camera moved or was refocused, by how much, and what that costs "
        "in mm. Exit status: 0 valid; 1 changed; 2 wrong use, or the pictures cannot tell; 3 failed.",
        example="labcal check rig.json shoot\n"
        "  labcal check rig.json photos --target rings-10x8 --cameras '_0=left,_1=right' --mend mended.json\n"
        "  labcal check rig.json detections.csv --target rings-10x8 --log checks.jsonl --page check.html\n"
        "  labcal check rig.json photos --markers apriltag-36h11 --places places.csv",
    )
    parser.add_argument("rig", type=Path, metavar="RIG", help="from 'labcal calibrate'")
    parser.add_argument(
        "pictures",
        nargs="+",
        metavar="SHOOT-or-IMAGES-or-TABLE",
        help="one shoot, or pictures and folders, or a table: detections.csv of dots, with --places "
        "pixels.csv of marks",
    )
    add_targets(parser)
    add_cameras(parser)
    parser.add_argument(
        "--dots",
        type=Path,
        metavar="RIG-dots.json",
        help="in place of --target: the dots of this print, from 'labcal calibrate --free-dots', which find "
        "smaller changes; RIG-dots.json beside the rig is taken by itself",
    )
    parser.add_argument(
        "--places",
        type=Path,
        metavar="places.csv",
        help="in place of --target: places of marks that stay where they are, from 'labcal measure' with "
        "this rig before; they tell which camera moved",
    )
    parser.add_argument(
        "--markers",
        metavar="KIND",
        help="with --places: the kinds of marks to look for, as of 'labcal measure'",
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
        "--temperature-c", type=decimal, metavar="C", help="temperature in the log, degrees Celsius"
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
    settings = CheckSettings(
        arguments.log,
        arguments.date,
        arguments.temperature_c,
        arguments.note,
        arguments.places,
        arguments.markers,
    )
    if arguments.page is None and arguments.mend is None:
        refuse_option(arguments, "force", "replaces a page or a corrected rig, and none is asked for")
    if arguments.mend is not None:
        given = [arguments.rig, *arguments.pictures, arguments.target, arguments.dots, arguments.places]
        read = paths_read(given)
        claim_outputs([FileOutput(arguments.mend, KIND)], read, force=arguments.force)
    page = asked_page(arguments, session, [arguments.rig, *arguments.pictures])
    if arguments.places is None:
        places = None if arguments.dots is None else read_places(arguments.dots)
        dots, target = _dots(arguments, session, None if places is None else places.target)
        found = check(arguments.rig, dots, places or target, settings, page=page)
    else:
        source = _marks(arguments, session, settings)
        found = check(arguments.rig, source, None, replace(settings, markers=None), page=page)
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


def _marks(arguments: Namespace, session: Session, settings: "CheckSettings") -> "NamedPixels | FoundMarks":
    """Return the pixels of fixed marks: those of a table, or those found in pictures."""
    from labcal.cameras.rig_file import read_rig
    from labcal.cli.compiling import announce_compiling
    from labcal.correspond.named_pixels_csv import is_pixels, read_pixels
    from labcal.pipeline import MarkSearch, detect_settings, find_marks, open_pictures

    for name in ("target", "dots"):
        refuse_option(arguments, name, "does not go with --places: fixed marks take the place of a target")
    first = Path(arguments.pictures[0])
    if len(arguments.pictures) == 1 and first.is_file() and is_pixels(first):
        for name in ("workers", "cameras", "raw", "markers"):
            refuse_option(arguments, name, "is for pictures; a table holds the pixels of their marks")
        if arguments.changes:
            raise InputError("--set is for finding marks in pictures; a table holds them. Leave it out.")
        return read_pixels(first)
    if not isinstance(settings.markers, MarkSearch):
        raise InputError(
            "Pictures are given, but not which marks to look for in them. Give --markers, as in "
            "'apriltag-36h11', or the table of their pixels."
        )
    pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
    for warning in pictures.warnings:
        session.warn(warning)
    search = replace(settings.markers, detector=detect_settings(arguments.changes))
    announce_compiling(session)
    with session.progress() as progress:
        return find_marks(read_rig(arguments.rig), pictures, search, arguments.workers, progress)


def _dots(
    arguments: Namespace, session: Session, known: "AnyTarget | None"
) -> "tuple[Detections, AnyTarget]":
    """Return the dots of a table, or those found in pictures, and what they are of."""
    from labcal.cameras.rig_file import read_rig
    from labcal.cli.compiling import announce_compiling
    from labcal.correspond.detections_csv import read_detections
    from labcal.correspond.dot_source import dots_found, is_dot_table
    from labcal.correspond.picture_set import target_shown
    from labcal.pipeline import detect_settings, measure_pictures, open_pictures

    first = Path(arguments.pictures[0])
    if len(arguments.pictures) == 1 and is_dot_table(first):
        for name in ("workers", "cameras", "raw"):
            refuse_option(arguments, name, "is for pictures; a table holds their dots")
        if arguments.changes:
            raise InputError("--set is for finding dots in pictures; a table holds them. Leave it out.")
        kept = read_rig(arguments.rig)
        return read_detections(first), known or target_shown(arguments.target, None, rig=kept).target
    pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
    target = known or pictures.target(arguments.target, read_rig(arguments.rig))
    settings = detect_settings(arguments.changes)
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
