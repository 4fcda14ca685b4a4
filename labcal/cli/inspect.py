"""``labcal inspect``: a contact sheet of a shoot."""

from argparse import Namespace

from labcal.cli.compiling import announce_compiling
from labcal.cli.options import add_detector_settings, add_output, add_pictures, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "inspect",
        run,
        "Draw a contact sheet: exposure, sharpness and dots of every picture, and where in each camera's "
        "picture dots were found.",
        example="labcal inspect shoot -o sheet.png",
    )
    add_pictures(parser)
    add_output(parser, "sheet.png", "picture to write")
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure, draw the sheet, report."""
    from labcal.correspond.paths_read import paths_read
    from labcal.pipeline import detect_settings, inspect, open_pictures
    from labcal.report.inspection import inspection_table
    from labcal.run.claims import claim_outputs
    from labcal.shoot.pictures import picture_output

    settings = detect_settings(arguments.changes)
    pictures = open_pictures(arguments.pictures, arguments.cameras)
    target = pictures.target(arguments.target)
    read = paths_read([*arguments.pictures, arguments.target], pictures.sources)
    claim_outputs([picture_output(arguments.output)], read, force=arguments.force)
    for warning in pictures.warnings:
        session.warn(warning)
    announce_compiling(session)
    with session.progress() as progress:
        found = inspect(pictures, target, settings, arguments.workers, progress)
    found.save(arguments.output, force=arguments.force)
    result = found.document(arguments.output)
    session.emit(result, inspection_table(result, target.count))
    refused = any(picture.reason is not None for picture in result.pictures)
    return ExitStatus.PARTIAL if refused else ExitStatus.DONE
