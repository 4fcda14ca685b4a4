"""``labcal evaluate``: errors of points in millimetres."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.holdout import add_holdout, refuse_without_holdout, run_held_out
from labcal.cli.options import TogetherAction, add_page, refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "evaluate",
        run,
        "Compute the errors of points, against the truth or, without one, against the target's own lengths.",
        example="labcal evaluate points.csv shoot",
    )
    parser.add_argument(
        "points",
        type=Path,
        metavar="points.csv",
        help="from 'labcal reconstruct'; with --holdout a table of dots, or a SHOOT",
    )
    parser.add_argument("shoot", nargs="?", type=Path, metavar="SHOOT", help="left out for loose photographs")
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=TogetherAction,
        help="the target of loose photographs, for its lengths; given several times: boards side by side",
    )
    parser.add_argument(
        "--dots",
        type=Path,
        metavar="RIG-dots.json",
        help="in place of --target: the dots of this print, from 'labcal calibrate --free-dots'",
    )
    parser.add_argument(
        "--detections",
        type=Path,
        metavar="FILE",
        help="the dots of the points; they give the limit of triangulation",
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
        help="the model or rig that the points were reconstructed with: views that it was calibrated from, "
        "or fitted to, are not scored, or are marked; RIG-dots.json and a shoot name theirs themselves; "
        "without SHOOT, --target and --dots, its target's lengths are taken",
    )
    add_holdout(parser)
    add_page(parser)
    parser.add_argument("--force", action="store_true", help="replace a page that labcal made")


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Evaluate and report."""
    if arguments.holdout is not None:
        return run_held_out(arguments, session)
    refuse_without_holdout(arguments)
    from labcal.cli.page import asked_page
    from labcal.correspond.points_csv import read_points
    from labcal.pipeline import evaluate
    from labcal.report.error_tables import error_table
    from labcal.shoot.dataset import Shoot, open_shoot
    from labcal.targets.catalogue import AnyTarget, target_of
    from labcal.targets.places import DotPlaces, read_places

    named = [one for one in (arguments.shoot, arguments.target, arguments.dots) if one is not None]
    if len(named) > 1 or (not named and arguments.rig is None):
        raise InputError(
            "Give the SHOOT that the points are of or, to compare with the target's own lengths, "
            "--target NAME or --dots RIG-dots.json: one of the three; or --rig alone, for the lengths of the "
            "target that it was calibrated with."
        )
    if arguments.page is None:
        refuse_option(arguments, "force", "replaces a page, and none is asked for")
    given = [arguments.points, arguments.shoot, arguments.dots, arguments.detections, arguments.rig]
    page = asked_page(arguments, session, given)
    points = read_points(arguments.points)
    source: Shoot | AnyTarget | DotPlaces | None = None
    if arguments.shoot is not None:
        source = open_shoot(arguments.shoot)
    elif arguments.dots is not None:
        source = read_places(arguments.dots)
    elif arguments.target is not None:
        source = target_of(arguments.target)
    errors = evaluate(points, source, arguments.detections, arguments.alignment, arguments.rig, page=page)
    for warning in errors.warnings:
        session.warn(warning)
    session.emit(errors, error_table(errors))
    return ExitStatus.DONE if errors.n_ok else ExitStatus.PARTIAL
