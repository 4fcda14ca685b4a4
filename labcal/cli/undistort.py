"""``labcal undistort``: pictures as ideal cameras would have taken them."""

import math
from argparse import ArgumentTypeError, Namespace
from pathlib import Path

from labcal.cli.options import add_cameras, add_output
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.run.decimal_words import decimal


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "undistort",
        run,
        "Make pictures as pinhole cameras in the same places would have taken them. DIR gets images, maps "
        "and the new cameras, rig.json.",
        example="labcal undistort rig.json photos --cameras '_0=left,_1=right' --rectify -o rectified",
    )
    parser.add_argument("model", type=Path, metavar="rig.json", help="the cameras, from 'labcal calibrate'")
    parser.add_argument(
        "pictures", nargs="+", metavar="SHOOT-or-IMAGES", help="one shoot, or pictures and folders"
    )
    add_cameras(parser)
    parser.add_argument(
        "--rectify", action="store_true", help="turn a pair so that a point has the same row in both pictures"
    )
    parser.add_argument(
        "--whole",
        action="store_true",
        help="enlarge the pictures so that nothing within 60 degrees of the axis is cut (as --rectify does)",
    )
    parser.add_argument(
        "--distance-mm",
        type=_distance,
        metavar="D",
        help="distance at which the pictures are right, for a lens prescription or behind a window",
    )
    add_output(parser, "DIR", "folder to appear")


def _distance(text: str) -> float:
    """Read a distance."""
    from labcal.bounds import LEAST_MM, MOST_MM

    try:
        value = decimal(text)
    except ValueError:
        value = math.nan
    if not LEAST_MM <= value <= MOST_MM:
        raise ArgumentTypeError(f"'{text}' should be a distance in mm, more than 0, up to {MOST_MM:g}")
    return value


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Resample all pictures and write them with the maps and the new cameras."""
    from labcal.pipeline import UndistortSettings, open_pictures, undistort
    from labcal.wording import counted

    how = UndistortSettings(arguments.rectify, arguments.whole, arguments.distance_mm, arguments.force)
    pictures = open_pictures(arguments.pictures, arguments.cameras, arguments.raw)
    with session.progress() as progress:
        result = undistort(arguments.model, pictures, arguments.output, how, progress)
    for warning in result.warnings:
        session.warn(warning)
    made = counted(len(result.images), "picture")
    session.emit(result, f"{result.folder}: {made} of {', '.join(result.cameras)}.")
    return ExitStatus.PARTIAL if result.skipped or result.inconsistent else ExitStatus.DONE
