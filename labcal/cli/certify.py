"""``labcal certify``: an acceptance test by known lengths, and its plan."""

from argparse import Namespace
from pathlib import Path

from labcal.cli.options import refuse_option
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError
from labcal.run.decimal_words import decimal

_OF_A_TEST = {
    "lengths": None, "rig": None, "limit_mm": None, "limit_ppm": 0.0, "rule": "iso-14253-1",
    "confidence": 0.95, "uncertainty": "reference", "pixel_sigma": None, "operator": None,
    "temperature_c": None, "date": None,
}  # fmt: skip
"""Options with their defaults."""


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "certify",
        run,
        "Test by known lengths whether errors stay within a limit, in the manner of VDI/VDE 2634 Part 1, and "
        "write a certificate. Status 0: conforming, or no limit is stated; 1: not conforming, undecided, or "
        "incomplete.",
        example="labcal certify --plan --volume-mm 400,300,200 -o lengths.csv\n"
        "  labcal certify rig.json pixels.csv --lengths lengths.csv --limit-mm 0.05 -o certificate.html\n"
        "  labcal certify points.csv --lengths lengths.csv --limit-mm 0.05 -o certificate.html",
    )
    parser.add_argument(
        "source",
        nargs="?",
        type=Path,
        metavar="RIG-or-points.csv",
        help="the rig that measures pixels.csv, or points from 'labcal measure' or 'labcal reconstruct'",
    )
    parser.add_argument(
        "points", nargs="?", type=Path, metavar="pixels.csv", help="the ends of the lengths, with a rig"
    )
    parser.add_argument(
        "--lengths",
        type=Path,
        metavar="lengths.csv",
        help="columns line, length, view_a, point_a, view_b, point_b, nominal_mm and, where known, sigma_mm "
        "(standard uncertainty of the calibrated length); a dot of a target is named col:row",
    )
    parser.add_argument(
        "-o",
        "--output",
        type=Path,
        metavar="FILE",
        help="the certificate, certificate.html; of --plan the form to fill in, lengths.csv",
    )
    parser.add_argument("--force", action="store_true", help="replace what labcal made there")
    parser.add_argument("--rig", type=Path, metavar="RIG", help="with points.csv: what measured them")
    parser.add_argument(
        "--limit-mm", type=decimal, metavar="MM", help="largest permissible error of a length"
    )
    parser.add_argument(
        "--limit-ppm", type=decimal, default=0.0, metavar="PPM", help="part of it that grows with the length"
    )
    parser.add_argument(
        "--rule",
        choices=["iso-14253-1", "simple"],
        default="iso-14253-1",
        help="decision rule: what is stated must be proven (default), or errors are compared as they are",
    )
    parser.add_argument(
        "--confidence",
        type=decimal,
        default=0.95,
        metavar="P",
        help="probability of what is proven (0.95)",
    )
    parser.add_argument(
        "--uncertainty",
        choices=["reference", "noise-and-reference"],
        default="reference",
        help="uncertainty of the test: that of the calibrated lengths, so that noise of the pixels counts as "
        "error (default); or both, so that the limit is for errors that stay in a repetition",
    )
    parser.add_argument(
        "--pixel-sigma", type=decimal, metavar="PX", help="noise of pixels that state no covariance"
    )
    parser.add_argument(
        "--volume-mm", metavar="X,Y,Z", help="sides of the volume that is tested, or planned for"
    )
    parser.add_argument("--operator", metavar="NAME", help="who makes the test")
    parser.add_argument("--temperature-c", type=decimal, metavar="DEG", help="temperature, degrees Celsius")
    parser.add_argument("--date", metavar="YYYY-MM-DD", help="date of the test (default: today)")
    parser.add_argument(
        "--plan", action="store_true", help="plan lengths over --volume-mm, and write the form to fill in"
    )
    parser.add_argument("--longest-mm", type=decimal, metavar="MM", help="of --plan: length of the scale bar")


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Plan, or test and report."""
    if arguments.output is None and arguments.force:
        refuse_option(arguments, "force", "replaces an output, and none is asked for")
    return _plan(arguments, session) if arguments.plan else _test(arguments, session)


def _plan(arguments: Namespace, session: Session) -> ExitStatus:
    """Write the form of a plan."""
    from labcal.cli.numbers import numbers
    from labcal.evaluate.acceptance.reference_lengths import KIND
    from labcal.pipeline import plan_lengths
    from labcal.report.certify_result import plan_result, plan_table
    from labcal.run.claims import FileOutput, claim_outputs

    for name, default in _OF_A_TEST.items():
        if getattr(arguments, name) != default:
            raise InputError(f"--{name.replace('_', '-')} goes with a test, not with its plan. Leave it out.")
    if arguments.source is not None:
        raise InputError(f"{arguments.source} goes with a test, not with its plan. Leave it out.")
    if arguments.volume_mm is None or arguments.output is None:
        raise InputError("A plan needs the volume and a form to write: --volume-mm X,Y,Z and -o lengths.csv.")
    claim_outputs([FileOutput(arguments.output, KIND)], [], force=arguments.force)
    plan = plan_lengths(numbers(arguments.volume_mm, "volume_mm"), arguments.longest_mm)
    plan.save(arguments.output, force=arguments.force)
    for warning in plan.warnings:
        session.warn(warning)
    result = plan_result(str(arguments.output), plan)
    session.emit(result, plan_table(result, plan))
    return ExitStatus.DONE


def _test(arguments: Namespace, session: Session) -> ExitStatus:
    """Make the test, and write the certificate."""
    from labcal.cli.numbers import numbers
    from labcal.cli.page import asked_page
    from labcal.evaluate.acceptance.decision import Outcome
    from labcal.pipeline import CertifySettings, certify
    from labcal.report.certify_result import certificate_table, certify_result

    refuse_option(arguments, "longest_mm", "goes with --plan")
    if arguments.source is None or arguments.lengths is None:
        raise InputError(
            "Give what was measured and the calibrated lengths: a rig and pixels.csv, or points.csv, and "
            "--lengths lengths.csv. 'labcal certify --plan' makes the form of the latter."
        )
    points, rig = arguments.source, arguments.rig
    if arguments.points is not None:
        refuse_option(arguments, "rig", "goes with a table of points; the rig of pixels is named first")
        points, rig = arguments.points, arguments.source
    given = {name: getattr(arguments, name) for name in _OF_A_TEST if name not in {"lengths", "rig"}}
    sides = numbers(arguments.volume_mm, "volume_mm") or None
    settings = CertifySettings(**given, volume_mm=sides)
    arguments.page = arguments.output
    page = asked_page(arguments, session, [points, arguments.lengths, rig])
    found = certify(points, arguments.lengths, settings, rig=rig, page=page)
    for warning in found.warnings:
        session.warn(warning)
    session.emit(certify_result(found), certificate_table(found))
    good = found.outcome in {Outcome.CONFORMING, Outcome.NO_LIMIT}
    return ExitStatus.DONE if good else ExitStatus.PARTIAL
