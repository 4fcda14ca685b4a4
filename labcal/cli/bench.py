"""``labcal bench``: benchmarks, every figure against its limit."""

from argparse import Namespace

from labcal.cli.methods import named_methods
from labcal.cli.options import add_output, add_scheduler, add_seed, positive_number
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "bench",
        run,
        "Measure how good labcal is, every figure against its limit, and write results.json.",
        example="labcal bench render --quick -o out/bench\n  labcal bench distortion --quick -o out/lenses",
    )
    parser.add_argument(
        "what",
        choices=("render", "detect", "solve", "distortion"),
        help="render: the rendered laboratory's own error and cost; detect: accuracy of the detector and "
        "of the dots that it measures; solve: errors of methods against the physical limit, and their speed; "
        "distortion: how far each method can be trusted as distortion grows",
    )
    parser.add_argument(
        "--quick",
        action="store_true",
        help="fewer pictures or cases; some ten minutes in place of an hour, or of days (distortion)",
    )
    parser.add_argument(
        "--only",
        metavar="GROUP,...",
        help="only some groups of checks; of detect: suite, accuracy, developed, real, bias, speed, hostile, "
        "coded-dots, tags, marks-in-space, chessboards, charuco, april-grids, traced-boards; of solve: "
        "limits, training, adjustment, mistakes, coverage, certify, check, compare, rehearse, real, mrcal, "
        "and budget, which are all that the error budget rests on (coverage to real, and the marks of "
        "detect); diagnose (mistaken shoots that are named), guided and boards (calibrations by boards of "
        "every kind) are measured only where they are named here",
    )
    parser.add_argument(
        "--method",
        metavar="NAME[,NAME]",
        help="of solve and distortion: methods to measure besides, of 'labcal method list' or "
        "package.module:Class of yours",
    )
    parser.add_argument(
        "--plan",
        metavar="NAME-or-FILE",
        help="of distortion: smallest (one cell), quick (as --quick), full (default, for a cluster), or a "
        "YAML file with factors and levels of yours",
    )
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="factor=level[,level]",
        dest="overrides",
        help="of distortion: levels in place of the plan's: --set families=water --set strengths=0,0.5,1; "
        "factors: methods, families, strengths, noise_px, points, layout, measured, faults, protocols; with "
        "--rendered also rendered.families and so on",
    )
    parser.add_argument(
        "--detections",
        metavar="SHOOT-or-FILE[,...]",
        help="of distortion: measure the methods also on views of yours of a target on a stage: folders of "
        "shoots, or detections.csv or corners.vnl beside their shoot.json",
    )
    parser.add_argument(
        "--seeds",
        type=positive_number,
        metavar="N",
        help="of distortion: number of repetitions, with the seeds S, S + 1, ...",
    )
    parser.add_argument(
        "--rendered",
        action="store_true",
        help="of distortion: measure through rendered pictures, too (which: --set rendered.strengths=0,1)",
    )
    parser.add_argument(
        "--yes",
        action="store_true",
        help="of distortion: begin work that takes more than four hours on this machine, which is refused "
        "without it (but not on a cluster at an address); the expected time is told before any work begins",
    )
    add_output(parser, "DIR", "folder to appear")
    add_seed(parser)
    add_scheduler(
        parser, "cases of 'distortion', or of 'solve' (groups limits, mistakes, coverage to rehearse),"
    )


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure and show the table."""
    from rich.console import Group

    from labcal.bench.distortion.cost import announcement
    from labcal.bench.distortion.method_seconds import seconds_table
    from labcal.bench.distortion.requested_plan import plan_of
    from labcal.bench.distortion.result import DistortionResult, distortion_table
    from labcal.pipeline import BenchSettings, bench
    from labcal.report.bench import bench_table

    groups = tuple(arguments.only.split(",")) if arguments.only else ()
    methods = () if arguments.method is None else tuple(named_methods(arguments.method))
    settings = BenchSettings(
        quick=arguments.quick,
        seed=arguments.seed,
        force=arguments.force,
        groups=groups,
        methods=methods,
        plan=arguments.plan,
        overrides=tuple(arguments.overrides),
        seeds=arguments.seeds,
        rendered=arguments.rendered,
        scheduler=arguments.scheduler,
        yes=arguments.yes,
        detections=tuple(arguments.detections.split(",")) if arguments.detections else (),
    )
    if arguments.what == "distortion":
        session.say(announcement(plan_of(settings), settings.scheduler))
    with session.progress() as progress:
        result = bench(arguments.what, arguments.output, settings, progress)
    if isinstance(result, DistortionResult):
        shown = Group(distortion_table(result), seconds_table(arguments.output / "timings.csv"))
    else:
        shown = Group(bench_table(result))
    session.emit(result, shown)
    return ExitStatus.PARTIAL if result.failed else ExitStatus.DONE
