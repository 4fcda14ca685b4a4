"""Options of PLY files beside a table of points."""

import argparse
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.errors import InputError

if TYPE_CHECKING:
    from labcal.correspond.named_points import NamedPoints
    from labcal.correspond.points import Points
    from labcal.run.claims import FileOutput


def add_ply(parser: argparse.ArgumentParser) -> None:
    """Add ``--ply`` and ``--encoding``."""
    parser.add_argument(
        "--ply",
        type=Path,
        metavar="FILE.ply",
        help="write the points as a point cloud, too, coloured by their standard deviations",
    )
    parser.add_argument(
        "--encoding",
        choices=["binary", "ascii"],
        default="binary",
        help="of the PLY file: little-endian bytes, or text (default %(default)s)",
    )


def ply_outputs(arguments: Namespace) -> "list[FileOutput]":
    """Return the PLY file to claim, where one is wanted.

    Raises
    ------
    InputError
        The table itself is named as a PLY file, or an encoding is given without a file.
    """
    from labcal.correspond.points_ply import KIND
    from labcal.run.claims import FileOutput

    if arguments.output.suffix.lower() == ".ply":
        raise InputError(
            f"{arguments.output} would be a table of points (CSV). Name a .csv file, and the cloud with "
            f"--ply {arguments.output}."
        )
    if arguments.ply is None:
        if arguments.encoding != "binary":
            raise InputError("--encoding goes with --ply FILE. Leave it out.")
        return []
    return [FileOutput(arguments.ply, KIND)]


def write_ply_beside(arguments: Namespace, points: "Points | NamedPoints") -> None:
    """Write the PLY file, where one is wanted."""
    from labcal.correspond.points_ply import write_ply

    if arguments.ply is not None:
        write_ply(arguments.ply, points, arguments.encoding, force=arguments.force)
