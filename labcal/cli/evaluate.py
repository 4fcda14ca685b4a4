"""``labcal evaluate``: errors of points in millimetres."""

from argparse import Namespace
from math import isnan
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.options import refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError
from labcal.wording import counted

if TYPE_CHECKING:
    from labcal.evaluate.against_truth import TruthErrors
    from labcal.evaluate.own_lengths import LengthErrors


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "evaluate",
        run,
        "Tell the errors of points, against the truth or, without one, against the target's own lengths.",
        example="labcal evaluate points.csv shoot",
    )
    parser.add_argument("points", type=Path, metavar="points.csv", help="from 'labcal reconstruct'")
    parser.add_argument("shoot", nargs="?", type=Path, metavar="SHOOT", help="left out for loose photographs")
    parser.add_argument("--target", metavar="NAME", help="the target of loose photographs, for its lengths")
    parser.add_argument(
        "--dots",
        type=Path,
        metavar="RIG-dots.json",
        help="in place of --target: where the dots of this print are, from 'labcal calibrate --free-dots'",
    )
    parser.add_argument(
        "--detections",
        type=Path,
        metavar="FILE",
        help="what the points came from; gives the limit of triangulation",
    )
    parser.add_argument(
        "--alignment",
        choices=["none", "rigid"],
        help="bring the points onto the truth first; rigid for a rig.json, whose world is its first camera "
        "(where not given: rigid for a hand-held target, else none)",
    )
    parser.add_argument(
        "--rig",
        type=Path,
        metavar="MODEL-or-rig.json",
        help="what the points were reconstructed with: views that it was calibrated from, or taught, are not "
        "scored, or are said to be; RIG-dots.json and a shoot tell so themselves",
    )


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Evaluate and tell."""
    from labcal.correspond.detections import read_detections
    from labcal.correspond.points import read_points
    from labcal.evaluate.against_truth import TruthErrors
    from labcal.pipeline import evaluate
    from labcal.reconstruct.reconstruction import calibration_views
    from labcal.shoot.dataset import Shoot, open_shoot
    from labcal.shoot.truth import has_truth
    from labcal.targets.catalogue import AnyTarget, load_target
    from labcal.targets.places import DotPlaces, read_places

    if [arguments.shoot, arguments.target, arguments.dots].count(None) != 2:  # noqa: PLR2004 -- one is given
        raise InputError(
            "Give the SHOOT that the points are of or, to compare with the target's own lengths, "
            "--target NAME or --dots RIG-dots.json: one of the three."
        )
    if arguments.shoot is None or not has_truth(arguments.shoot):
        for option in ("detections", "alignment"):
            refuse_option(
                arguments, option, "goes with the truth of a rendered shoot, which is not given here"
            )
    points = read_points(arguments.points)
    learned = None if arguments.rig is None else calibration_views(arguments.rig)
    source: Shoot | AnyTarget | DotPlaces
    if arguments.shoot is not None:
        source = open_shoot(arguments.shoot)
    else:
        source = read_places(arguments.dots) if arguments.dots else load_target(arguments.target)
    detections = None if arguments.detections is None else read_detections(arguments.detections)
    errors = evaluate(points, source, detections, arguments.alignment, learned or None)
    for warning in errors.warnings:
        session.warn(warning)
    session.emit(errors, _against_truth(errors) if isinstance(errors, TruthErrors) else _of_lengths(errors))
    return ExitStatus.DONE if errors.n_ok else ExitStatus.PARTIAL


def _against_truth(errors: "TruthErrors") -> object:
    from rich.table import Table

    from labcal.evaluate.scored_views import scored_description

    x, y, z = errors.mean_signed_mm
    caption = (
        f"scored: {errors.scored}, {counted(errors.not_scored, 'other')} not; alignment: {errors.alignment}\n"
        f"{scored_description(len(errors.views_scored), errors.views_calibrated_on)}"
    )
    table = Table("error against truth", "mm", caption=caption)
    table.add_row("points", str(errors.n))
    table.add_row("mean, with sign (x, y, z)", f"{x:+.4f}, {y:+.4f}, {z:+.4f}")
    for name, value in (
        ("mean length", errors.mae_mm),
        ("RMS", errors.rmse_mm),
        ("95th percentile", errors.p95_mm),
        ("greatest", errors.max_mm),
        ("limit of triangulation from two pictures alone (RMS)", errors.limit_mm),
    ):
        if not isnan(value):  # the limit, without detections
            table.add_row(name, f"{value:.4f}")
    if not isnan(errors.coverage95):
        table.add_row("within the stated 95% ellipsoid", f"{100 * errors.coverage95:.1f} %")
    return table


def _of_lengths(errors: "LengthErrors") -> object:
    from rich.table import Table

    from labcal.evaluate.scored_views import scored_description

    told = scored_description(len(errors.views_scored), errors.views_calibrated_on)
    table = Table("error of lengths on the target", "", caption=f"{counted(errors.n, 'length')} in {told}")
    table.add_row("greatest", f"{errors.length_error_mm.max:.4f} mm")
    table.add_row("RMS", f"{errors.length_error_mm.rms:.4f} mm")
    table.add_row("scale", f"{errors.scale_ppm:+.1f} ppm")
    return table
