"""Marks in pictures, as ``measure`` looks for them."""

import argparse
from argparse import Namespace
from pathlib import Path

from labcal.cli.compiling import announce_compiling
from labcal.cli.methods import own_method
from labcal.cli.named_points import frame_path, measure_settings, point_outputs, write_points
from labcal.cli.options import add_cameras, add_detector_settings, add_workers, refuse_option
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.run.decimal_words import decimal

_WITH_MARKS = ("mark_diameter", "cameras", "raw", "tone_curve", "overlay", "pixels", "workers")


def add_marks(parser: argparse.ArgumentParser) -> None:
    """Add the options of marks, and of the pictures that they are looked for in."""
    parser.add_argument(
        "--markers",
        action="append",
        default=[],
        metavar="KIND",
        help="look for these marks in pictures: AprilTags (apriltag-36h11), ArUco markers (aruco-4x4-50), "
        "coded dots by their code (ring-23) or sheet (coded-8x6); several with commas",
    )
    parser.add_argument(
        "--dots",
        action="append_const",
        const="dots",
        dest="markers",
        help="look for plain round dots, which are matched between the cameras of a rig by its geometry; the "
        "same as --markers dots",
    )
    parser.add_argument(
        "--mark-diameter",
        type=decimal,
        metavar="MM",
        help="diameter of plain and of coded dots, by which wrong matches and wrong scales are told; a sheet "
        "of coded dots states its own",
    )
    add_cameras(parser)
    parser.add_argument(
        "--tone-curve",
        default="linear",
        metavar="CURVE",
        help="undo the camera's tone curve first, as of 'labcal detect'",
    )
    parser.add_argument(
        "--overlay", type=Path, metavar="DIR", help="folder for pictures with the marks drawn in"
    )
    parser.add_argument(
        "--pixels",
        type=Path,
        metavar="pixels.csv",
        help="table of the marks' named pixels to write, from which 'labcal measure' makes the same points",
    )
    add_detector_settings(parser)
    add_workers(parser)


def refuse_marks(arguments: Namespace) -> None:
    """Raise where options of marks are given and no marks are looked for.

    Raises
    ------
    InputError
        They are.
    """
    if arguments.changes:
        arguments.set = arguments.changes
        refuse_option(arguments, "set", _USE)
    if arguments.tone_curve == "linear":
        arguments.tone_curve = None
    for name in _WITH_MARKS:
        refuse_option(arguments, name, _USE)


_USE = "goes with marks in pictures, --markers or --dots, and not with a table of named pixels"


def write_marks(arguments: Namespace, session: Session) -> ExitStatus:
    """Find marks, measure them, and write points, pixels and overlays."""
    from labcal.correspond.named_pixels_csv import KIND as PIXELS
    from labcal.correspond.named_pixels_csv import pixels_csv
    from labcal.correspond.paths_read import paths_read
    from labcal.pipeline import (
        MarkSearch,
        detect_settings,
        find_marks,
        open_pictures,
        write_mark_overlays,
    )
    from labcal.pipeline.marks import refuse_pixel_sigma, refuse_pixels
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.report.mark_overlays import mark_overlay_command
    from labcal.run.claims import FileOutput, FolderOutput, claim_outputs
    from labcal.run.outputs import write_file

    outputs, settings = point_outputs(arguments), measure_settings(arguments)
    search = MarkSearch(
        ",".join(arguments.markers),
        arguments.mark_diameter,
        arguments.tone_curve,
        detect_settings(arguments.changes),
    )
    refuse_pixels(arguments.source)
    refuse_pixel_sigma(settings.pixel_sigma)
    pictures = open_pictures(arguments.source, arguments.cameras, arguments.raw)
    if arguments.pixels is not None:
        outputs.append(FileOutput(arguments.pixels, PIXELS))
    if arguments.overlay is not None:
        outputs.append(FolderOutput(arguments.overlay, mark_overlay_command(pictures.sources)))
    given = [arguments.model, *arguments.source, arguments.target, arguments.tone_curve]
    read = paths_read([*given, frame_path(settings)], pictures.sources)
    claim_outputs(outputs, read, force=arguments.force)
    model = load_reconstructor(arguments.model, own_method(arguments.method))
    for warning in pictures.warnings:
        session.warn(warning)
    announce_compiling(session)
    with session.progress() as progress:
        found = find_marks(model, pictures, search, arguments.workers, progress)
    if arguments.overlay is not None:
        write_mark_overlays(arguments.overlay, found, force=arguments.force)
    if arguments.pixels is not None:
        write_file(arguments.pixels, pixels_csv(found.pixels), kind=PIXELS, force=arguments.force)
    return write_points(arguments, model, found, settings, session)
