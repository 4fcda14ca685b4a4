"""``labcal inspect``: a shoot at a glance, as a page or as a picture."""

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
        "Show exposure, sharpness and dots of every picture, and where in each camera's picture dots were "
        "found: as a page to look at, or as a contact sheet.",
        example="labcal inspect shoot -o sheet.html",
    )
    add_pictures(parser)
    add_output(parser, "sheet.html", "page to write or, by the ending .png or .jpg, contact sheet")
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure, draw the sheet, report."""
    from labcal.cli.page import asked_page
    from labcal.correspond.paths_read import paths_read
    from labcal.pipeline import detect_settings, inspect, open_pictures
    from labcal.report.inspection import inspection_table
    from labcal.report.page.output import is_page
    from labcal.run.claims import claim_outputs
    from labcal.shoot.pictures import picture_output

    settings = detect_settings(arguments.changes)
    pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
    target = pictures.target(arguments.target)
    read = paths_read([*arguments.pictures, arguments.target], pictures.sources)
    page = None
    if is_page(arguments.output):
        arguments.page = arguments.output
        page = asked_page(arguments, session, arguments.pictures)
    claim_outputs(
        [picture_output(arguments.output) if page is None else page.file], read, force=arguments.force
    )
    for warning in pictures.warnings:
        session.warn(warning)
    announce_compiling(session)
    with session.progress() as progress:
        found = inspect(pictures, target, settings, arguments.workers, progress, page=page)
    if page is None:
        found.save(arguments.output, force=arguments.force)
    result = found.document(arguments.output)
    session.emit(result, inspection_table(result, target.count))
    refused = any(picture.reason is not None for picture in result.pictures)
    return ExitStatus.PARTIAL if refused else ExitStatus.DONE
