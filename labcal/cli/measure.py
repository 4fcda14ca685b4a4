"""``labcal measure``: points in space from named pixels, or from marks in pictures."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.marks import add_marks, refuse_marks, write_marks
from labcal.cli.named_points import add_budget, add_displacements, add_named_points, write_named
from labcal.cli.options import OnceAction, add_output
from labcal.cli.parser import CommandGroup
from labcal.cli.ply import add_ply
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "measure",
        run,
        "Measure points that are not a target's: marks in pictures, or named pixels of any number of "
        "cameras, missing in some.",
        example="labcal measure rig.json shoot --markers coded-8x6 -o points.csv\n"
        "  labcal measure rig.json pixels.csv --pixel-sigma 0.1 -o points.csv\n"
        "  labcal measure rig.json pixels.csv --frame points:origin,x,plane -o points.csv --ply points.ply\n"
        "  labcal measure rig.json pixels.csv -o points.csv --displacements moved.csv --reference-view start",
    )
    parser.add_argument(
        "model", type=Path, metavar="RIG-or-MODEL", help="from 'labcal calibrate' or 'labcal fit'"
    )
    parser.add_argument(
        "source",
        nargs="+",
        metavar="SHOOT-or-IMAGES-or-pixels.csv",
        help="with --markers or --dots one shoot, or pictures and folders; else a table with the columns "
        "view, camera, point, x_px, y_px and, where known, var_xx, var_xy, var_yy; 'labcal convert' makes it "
        "from tables of other programs",
    )
    add_marks(parser)
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=OnceAction,
        help="the target that lies in the frame, of --frame board:detections.csv (default: that of the "
        "rig's calibration)",
    )
    parser.add_argument(
        "--method",
        metavar="MODULE:CLASS",
        help="the method of your own that the model was fitted with, as it was named to 'labcal fit'",
    )
    add_budget(parser)
    add_output(parser, "points.csv", "table of points to write")
    add_named_points(parser)
    add_displacements(parser)
    add_ply(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure and write the points."""
    if arguments.markers:
        return write_marks(arguments, session)
    from labcal.pipeline.named_points import refuse_pictures

    for path in arguments.source:
        refuse_pictures(path)
    refuse_marks(arguments)
    if len(arguments.source) > 1:
        raise InputError(
            f"One table of named pixels is measured at a time, but {len(arguments.source)} are given. "
            "Measure them one by one."
        )
    return write_named(arguments, arguments.source[0], session)
