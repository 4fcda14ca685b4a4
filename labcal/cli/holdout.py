"""``labcal evaluate --holdout``: lengths in views that each calibration has not seen."""

import argparse
from argparse import Namespace

from labcal.cli.dot_places import add_dot_places, dot_treatment
from labcal.cli.options import refuse_option
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

_DEFAULT = 0
"""Number of parts that stands for that of the library."""


def add_holdout(parser: argparse.ArgumentParser) -> None:
    """Add ``--holdout`` and what goes with it."""
    parser.add_argument(
        "--holdout",
        type=int,
        nargs="?",
        const=_DEFAULT,
        metavar="PARTS",
        help="instead of points, of dots: calibrate from all parts of the views but one and measure that "
        "one, in turn (4 parts); the target's lengths are then no circular check",
    )
    parser.add_argument("--lens", metavar="MODEL", help="with --holdout: lens model, or auto (that of --rig)")
    add_dot_places(parser, "; with --holdout")


def refuse_without_holdout(arguments: Namespace) -> None:
    """Raise where something is given that goes with ``--holdout`` alone."""
    refuse_option(arguments, "lens", "goes with --holdout, which calibrates")
    refuse_option(arguments, "free_dots", "goes with --holdout, which calibrates")
    refuse_option(arguments, "keep_dots", "goes with --holdout, which calibrates")


def run_held_out(arguments: Namespace, session: Session) -> ExitStatus:
    """Calibrate and measure part by part, and report."""
    from labcal.calibrate.handheld import HandheldSettings
    from labcal.cameras.rig_file import read_rig
    from labcal.correspond.dot_source import open_dots
    from labcal.pipeline import evaluate_held_out
    from labcal.report.error_tables import error_table
    from labcal.targets.catalogue import target_of

    for name in ("shoot", "alignment", "page"):
        refuse_option(arguments, name, "goes with points, and --holdout takes dots")
    settings = HandheldSettings(dot_places=dot_treatment(arguments), dots=arguments.dots)
    named = None if arguments.target is None else target_of(arguments.target)
    given = open_dots(arguments.points, arguments.detections)
    if named is None and given.shoot is None and settings.places is not None:
        named = settings.places.target
    target = given.target(named)
    lens = arguments.lens
    if lens is None and arguments.rig is not None:
        lenses = {record.lens for record in read_rig(arguments.rig).cameras.values()}
        lens = lenses.pop() if len(lenses) == 1 else None
    with session.progress() as progress:
        errors = evaluate_held_out(
            given.showing(target), given.table, lens, settings, arguments.holdout or None, progress
        )
    for warning in errors.warnings:
        session.warn(warning)
    session.emit(errors, error_table(errors))
    return ExitStatus.DONE if errors.n_ok else ExitStatus.PARTIAL
