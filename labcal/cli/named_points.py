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

if TYPE_CHECKING:
    from labcal.cameras.rig import Rig
    from labcal.estimators.model import Model
    from labcal.pipeline import MeasureSettings
    from labcal.reconstruct.found_marks import FoundMarks

OPTIONS = ("pixel_sigma", "frame", "frame_view")


def add_named_points(parser: argparse.ArgumentParser) -> None:
    """Add the fields of `MeasureSettings` as options."""
    parser.add_argument(
        "--pixel-sigma",
        type=float,
        metavar="PX",
        help="standard deviation of x and of y of the named pixels that state no covariance",
    )
    parser.add_argument(
        "--frame",
        metavar="KIND:NAMES-or-FILE",
        help="frame of the named points: points:ORIGIN,ON-X,IN-PLANE; board:detections.csv with --target; "
        "rigid:known.csv or similarity:known.csv (columns point, X_mm, Y_mm, Z_mm and, where known, "
        "sigma_mm)",
    )
    parser.add_argument(
        "--frame-view", metavar="VIEW", help="the view that determines the frame, where several could"
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


def write_named(arguments: Namespace, source: str | Path, session: Session) -> ExitStatus:
    """Measure the points of named pixels, and write them."""
    from labcal.correspond.named_points_csv import KIND
    from labcal.correspond.paths_read import paths_read
    from labcal.pipeline import MeasureSettings
    from labcal.reconstruct.frames.requested_frame import RequestedFrame
    from labcal.reconstruct.reconstruction import load_reconstructor
    from labcal.run.claims import FileOutput, claim_outputs

    settings = MeasureSettings(**{name: getattr(arguments, name) for name in OPTIONS})
    frame = None if settings.frame is None else RequestedFrame.of(settings.frame)
    read = paths_read([arguments.model, source, arguments.target, None if frame is None else frame.path])
    claim_outputs([FileOutput(arguments.output, KIND), *ply_outputs(arguments)], read, force=arguments.force)
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
    from labcal.report.measure_result import measure_report, measure_result
    from labcal.run.outputs import write_file

    found = measure(model, source, arguments.target, settings)
    write_file(arguments.output, named_points_csv(found.points), kind=KIND, force=arguments.force)
    write_ply_beside(arguments, found.points)
    result = measure_result(arguments.output, model, found)
    for warning in found.warnings:
        session.warn(warning)
    session.emit(result, measure_report(result))
    refused = result.marks is not None and result.marks.refused > 0
    complete = not refused and result.inconsistent is None and result.flags.keys() <= {
        PointFlag.OK.value, PointFlag.EXTRAPOLATED.value, PointFlag.MODEL_MISFIT.value
    }  # fmt: skip
    return ExitStatus.DONE if complete and PointFlag.OK.value in result.flags else ExitStatus.PARTIAL
