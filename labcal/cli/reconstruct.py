"""``labcal reconstruct``: points in space from dots."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.methods import own_method
from labcal.cli.named_points import add_budget, add_named_points, refuse_named_points, write_named
from labcal.cli.options import TogetherAction, add_detector_settings, add_output, add_workers
from labcal.cli.parser import CommandGroup
from labcal.cli.ply import add_ply, ply_outputs, write_ply_beside
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "reconstruct",
        run,
        "Reconstruct the dots that all cameras of a model measured, or named pixels (as 'labcal measure').",
        example="labcal reconstruct model.safetensors shoot -o points.csv",
    )
    parser.add_argument(
        "model", type=Path, metavar="MODEL-or-rig.json", help="from 'labcal fit' or 'labcal calibrate'"
    )
    parser.add_argument(
        "source",
        metavar="SHOOT-or-detections.csv-or-pixels.csv",
        help="a shoot, its table of dots, or a table of named pixels",
    )
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=TogetherAction,
        help="the target of the dots, for the eccentricity correction (default: that of the shoot, else that "
        "of the rig's calibration); given several times: boards side by side; with named pixels, the one of "
        "--frame board:detections.csv",
    )
    parser.add_argument(
        "--method",
        metavar="MODULE:CLASS",
        help="the method of your own that the model was fitted with, as it was named to 'labcal fit'",
    )
    add_budget(parser)
    add_output(parser, "points.csv", "table of points to write")
    add_named_points(parser)
    add_ply(parser)
    add_detector_settings(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Reconstruct and write the points."""
    from labcal.cameras.rig import Rig
    from labcal.cli.dots import dots_given, refuse_idle_detection
    from labcal.correspond.dot_source import open_dots
    from labcal.correspond.named_pixels_csv import is_pixels
    from labcal.correspond.paths_read import paths_read
    from labcal.correspond.points import PointFlag
    from labcal.correspond.points_csv import KIND, points_csv
    from labcal.pipeline import reconstruct
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.report.reconstruct_result import reconstruct_result, reconstruct_words
    from labcal.run.claims import FileOutput, claim_outputs
    from labcal.run.outputs import write_file

    if is_pixels(arguments.source):
        refuse_idle_detection(arguments)
        return write_named(arguments, arguments.source, session)
    refuse_named_points(arguments)
    refuse_idle_detection(arguments)
    read = paths_read([arguments.model, arguments.source, arguments.target])
    claim_outputs([FileOutput(arguments.output, KIND), *ply_outputs(arguments)], read, force=arguments.force)
    model = load_reconstructor(arguments.model, own_method(arguments.method))
    given = open_dots(arguments.source)
    rig = model if isinstance(model, Rig) else None
    known = arguments.target is not None or given.states_target(rig)
    target = given.target(arguments.target, rig) if known else None
    # A shoot's dots are found by its own target, whatever they are then said to be of.
    detections = dots_given(given, given.in_pictures(target), arguments, session)
    found = reconstruct(model, detections, target, budget=arguments.budget)
    write_file(arguments.output, points_csv(found.points), kind=KIND, force=arguments.force)
    write_ply_beside(arguments, found.points)
    result = reconstruct_result(arguments.output, model, found)
    for warning in found.warnings:
        session.warn(warning)
    session.emit(result, reconstruct_words(result))
    return (
        ExitStatus.PARTIAL
        if result.inconsistent or PointFlag.OK.value not in result.flags
        else ExitStatus.DONE
    )
