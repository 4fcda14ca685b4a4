"""``labcal measure``: points in space from named pixels."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.named_points import add_budget, add_displacements, add_named_points, write_named
from labcal.cli.options import add_output
from labcal.cli.parser import CommandGroup
from labcal.cli.ply import add_ply
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "measure",
        run,
        "Measure points that are not a target's: named pixels of any number of cameras, missing in some.",
        example="labcal measure rig.json pixels.csv --pixel-sigma 0.1 -o points.csv\n"
        "  labcal measure rig.json pixels.csv --frame points:origin,x,plane -o points.csv --ply points.ply\n"
        "  labcal measure rig.json pixels.csv -o points.csv --displacements moved.csv --reference-view start",
    )
    parser.add_argument(
        "model", type=Path, metavar="RIG-or-MODEL", help="from 'labcal calibrate' or 'labcal fit'"
    )
    parser.add_argument(
        "pixels",
        type=Path,
        metavar="pixels.csv",
        help="columns view, camera, point, x_px, y_px and, where known, var_xx, var_xy, var_yy; 'labcal "
        "convert' makes it from tables of other programs",
    )
    parser.add_argument(
        "--target", metavar="NAME", help="the target that lies in the frame, of --frame board:detections.csv"
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
    return write_named(arguments, arguments.pixels, session)
