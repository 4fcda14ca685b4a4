"""Points of named pixels, as ``measure`` and ``reconstruct`` write them."""

import argparse
from argparse import Namespace
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.methods import own_method
from labcal.cli.options import refuse_option
from labcal.cli.ply import ply_outputs, write_ply_beside
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.run.decimal_words import decimal

if TYPE_CHECKING:
    from labcal.cameras.rig import Rig
    from labcal.estimators.model import Model
    from labcal.pipeline import MeasureSettings
    from labcal.reconstruct.found_marks import FoundMarks
    from labcal.run.claims import Output

OPTIONS = ("pixel_sigma", "frame", "frame_view", "scale_bars", "scale_sigma_ppm")


def add_named_points(parser: argparse.ArgumentParser) -> None:
    """Add the fields of `MeasureSettings` as options."""
    parser.add_argument(
        "--pixel-sigma",
        type=decimal,
        metavar="PX",
        help="standard deviation of x and of y of the named pixels that state no covariance",
    )
    parser.add_argument(
        "--frame",
        metavar="KIND:NAMES-or-FILE",
        help="frame of the named points: points:ORIGIN,ON-X,IN-PLANE; board:detections.csv of --target; "
        "rigid:known.csv or similarity:known.csv (columns point, X_mm, Y_mm, Z_mm and, where known, "
        "sigma_mm)",
    )
    parser.add_argument(
        "--frame-view", metavar="VIEW", help="the view that determines the frame, where several could"
    )
    parser.add_argument(
        "--scale-bar",
        dest="scale_bars",
        action="append",
        metavar="ONE,OTHER,LENGTH,SIGMA",
        help="known distance between two named points, mm, which corrects points and cameras; "
        "may be given several times",
    )
    parser.add_argument(
        "--scale-sigma-ppm",
        type=decimal,
        metavar="PPM",
        help="standard deviation of the rig's scale before the bars (default: the bars alone give the scale)",
    )


def add_displacements(parser: argparse.ArgumentParser) -> None:
    """Add the table of displacements, of points over time."""
    parser.add_argument(
        "--displacements",
        type=Path,
        metavar="displacements.csv",
        help="also write the displacements of the points since a view, with rigid motions in the summary",
    )
    parser.add_argument(
        "--reference-view", metavar="VIEW", help="the view that displacements begin at (default: the first)"
    )


def add_budget(parser: argparse.ArgumentParser) -> None:
    """Add ``--budget``, of dots and of named points."""
    parser.add_argument(
        "--budget",
        choices=("full", "noise"),
        help="sources of errors in the covariances of a rig's points: pixel noise and calibration (default, "
        "if the rig states its covariance), or pixel noise alone",
    )


def refuse_named_points(arguments: Namespace) -> None:
    """Raise where options of named pixels are given and there are none.

    Raises
    ------
    InputError
        They are.
    """
    for name in OPTIONS:
        refuse_option(arguments, name, "goes with a table of named pixels, not with dots of a target")


def measure_settings(arguments: Namespace) -> "MeasureSettings":
    """Return the settings that the options ask for."""
    from labcal.pipeline import MeasureSettings

    given = {name: getattr(arguments, name) for name in OPTIONS}
    return MeasureSettings(**given | {"scale_bars": arguments.scale_bars or ()})


def frame_path(settings: "MeasureSettings") -> Path | None:
    """Return the file that determines the frame of the points, if one does."""
    from labcal.reconstruct.frames.requested_frame import RequestedFrame

    return None if settings.frame is None else RequestedFrame.of(settings.frame).path


def point_outputs(arguments: Namespace) -> "list[Output]":
    """Return the files that points are written to: their table, displacements and point cloud.

    Raises
    ------
    InputError
        A view to compare with is named, and no table of displacements.
    """
    from labcal.correspond.named_points_csv import KIND
    from labcal.errors import InputError
    from labcal.reconstruct.displacements_csv import KIND as DISPLACEMENTS
    from labcal.run.claims import FileOutput

    table: Path | None = getattr(arguments, "displacements", None)
    if table is None and getattr(arguments, "reference_view", None) is not None:
        raise InputError("--reference-view goes with --displacements. Give a table, too, or leave it out.")
    outputs: list[Output] = [FileOutput(arguments.output, KIND)]
    outputs += [] if table is None else [FileOutput(table, DISPLACEMENTS)]
    return [*outputs, *ply_outputs(arguments)]


def write_named(arguments: Namespace, source: str | Path, session: Session) -> ExitStatus:
    """Measure the points of named pixels, and write them."""
    from labcal.correspond.paths_read import paths_read
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.run.claims import claim_outputs

    outputs, settings = point_outputs(arguments), measure_settings(arguments)
    read = paths_read([arguments.model, source, arguments.target, frame_path(settings)])
    claim_outputs(outputs, read, force=arguments.force)
    model = load_reconstructor(arguments.model, own_method(arguments.method))
    return write_points(arguments, model, source, settings, session)


def write_points(
    arguments: Namespace,
    model: "Model | Rig",
    source: "str | Path | FoundMarks",
    settings: "MeasureSettings",
    session: Session,
) -> ExitStatus:
    """Write the points of named pixels, or of marks, to places that are claimed."""
    from labcal.correspond.named_points_csv import KIND, named_points_csv
    from labcal.correspond.points import PointFlag
    from labcal.pipeline import measure
    from labcal.reconstruct.displacements import displacements
    from labcal.report.measure_result import measure_report, measure_result
    from labcal.run.outputs import write_file

    found = measure(model, source, arguments.target, settings, budget=arguments.budget)
    table: Path | None = getattr(arguments, "displacements", None)
    moved = None if table is None else (table, displacements(found, arguments.reference_view))
    write_file(arguments.output, named_points_csv(found.points), kind=KIND, force=arguments.force)
    write_ply_beside(arguments, found.points)
    if moved is not None:
        moved[1].save(moved[0], force=arguments.force)
    result = measure_result(arguments.output, model, found, moved)
    for warning in result.warnings:
        session.warn(warning)
    session.emit(result, measure_report(result))
    refused = result.marks is not None and result.marks.refused > 0
    complete = not refused and result.inconsistent is None and result.flags.keys() <= {
        PointFlag.OK.value, PointFlag.EXTRAPOLATED.value, PointFlag.MODEL_MISFIT.value
    }  # fmt: skip
    return ExitStatus.DONE if complete and PointFlag.OK.value in result.flags else ExitStatus.PARTIAL
