"""``labcal detect``: dots in pictures."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.compiling import announce_compiling
from labcal.cli.options import add_detector_settings, add_output, add_pictures, add_workers, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.print_scale import add_print_scale, scaled_target, store_scale
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "detect",
        run,
        "Find the dots in the pictures of a shoot, or in loose pictures, and number them by the target.",
        example="labcal detect photos --target rings-10x8 --cameras '_0=left,_1=right' -o detections.csv",
    )
    add_pictures(parser)
    add_print_scale(parser, "it goes into shoot.json; of loose pictures give it to 'labcal calibrate'")
    add_output(parser, "detections.csv", "table of dots to write")
    parser.add_argument(
        "--overlay", type=Path, metavar="DIR", help="folder for pictures with the dots drawn in"
    )
    parser.add_argument(
        "--tone-curve",
        default="linear",
        metavar="CURVE",
        help="undo the camera's tone curve first: srgb, rec709, gamma-2.2, or a CSV file with the columns "
        "value,light rising from 0,0 to 1,1 (default linear; curves of S shape move dots, the others hardly)",
    )
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Detect, write the table, report the outcome of each picture."""
    from labcal.correspond.detections_csv import KIND, detections_csv
    from labcal.correspond.measure import detections_of
    from labcal.correspond.paths_read import paths_read
    from labcal.pipeline import detect_settings, measure_pictures, open_pictures
    from labcal.report.detect_result import detect_result, detect_table
    from labcal.report.overlays import overlay_command, write_overlays
    from labcal.run.claims import FileOutput, FolderOutput, Output, claim_outputs
    from labcal.run.executor import open_executor
    from labcal.run.outputs import write_file
    from labcal.shoot.tone_curve import find_tone_curve

    tone_curve, settings = find_tone_curve(arguments.tone_curve), detect_settings(arguments.changes)
    pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
    if pictures.shoot is None:
        refuse_option(
            arguments, "print_scale", "is stored in a shoot; of loose pictures 'calibrate' takes it"
        )
    outputs: list[Output] = [FileOutput(arguments.output, KIND)]
    if arguments.overlay is not None:
        outputs.append(FolderOutput(arguments.overlay, overlay_command(pictures.sources)))
    read = paths_read([*arguments.pictures, arguments.target, arguments.tone_curve], pictures.sources)
    claim_outputs(outputs, read, force=arguments.force)
    for warning in pictures.warnings:
        session.warn(warning)
    announce_compiling(session)
    with session.progress() as progress:
        with open_executor(arguments.workers) as executor:
            shown = pictures.shown(arguments.target, executor, progress)
        if arguments.print_scale is not None and pictures.shoot is not None:
            store_scale(pictures.shoot, scaled_target(shown.target, arguments), session)
        measurements = measure_pictures(
            pictures, shown.printed, settings, tone_curve, arguments.workers, progress
        )
    target = shown.target
    if arguments.overlay is not None:
        write_overlays(arguments.overlay, measurements, target, force=arguments.force)
    result = detect_result(measurements, shown)
    if any((image.numberings or 1) > 1 for image in result.images):
        session.warn(
            f"'{target.name}' looks the same when it is turned: all cameras of a view agree on its dots, but "
            "views may differ by such a turn. This does not matter to 'labcal calibrate'"
        )
    if result.indexed == 0:
        session.emit(result, detect_table(result))
        session.warn(f"no picture has dots that can be used, so {arguments.output} was not written")
        return ExitStatus.UNUSABLE
    table = detections_csv(detections_of(measurements))
    write_file(arguments.output, table, kind=KIND, force=arguments.force)
    session.emit(result, detect_table(result))
    return ExitStatus.PARTIAL if result.refused else ExitStatus.DONE
