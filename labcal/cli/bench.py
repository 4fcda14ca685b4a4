"""``labcal bench``: benchmarks, every figure against its limit."""

from argparse import Namespace

from labcal.cli.methods import named_methods
from labcal.cli.options import add_output, add_scheduler, add_seed
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "bench",
        run,
        "Measure how good labcal is, every figure against its limit, and write results.json.",
        example="labcal bench render --quick -o out/bench-render",
    )
    parser.add_argument(
        "what",
        choices=("render", "detect", "solve"),
        help="render: the rendered laboratory's own error and cost; detect: accuracy of the detector and "
        "of the dots that it measures; solve: errors of methods against the physical limit, and their speed",
    )
    parser.add_argument(
        "--quick", action="store_true", help="fewer pictures; some ten minutes in place of an hour"
    )
    parser.add_argument(
        "--only",
        metavar="GROUP,...",
        help="only some groups of checks; of detect: suite, accuracy, real, bias, speed, hostile; "
        "of solve: limits, training, adjustment, mistakes, real, mrcal",
    )
    parser.add_argument(
        "--method",
        metavar="NAME[,NAME]",
        help="of solve: methods to measure besides, of 'labcal method list' or package.module:Class of yours",
    )
    add_output(parser, "DIR", "folder to appear")
    add_seed(parser)
    add_scheduler(parser, "cases of 'solve' (groups limits and mistakes)")


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure and show the table."""
    from labcal.pipeline import BenchSettings, bench
    from labcal.report.bench import bench_table

    groups = tuple(arguments.only.split(",")) if arguments.only else ()
    methods = () if arguments.method is None else tuple(named_methods(arguments.method))
    settings = BenchSettings(
        arguments.quick, arguments.seed, arguments.force, groups, methods, arguments.scheduler
    )
    with session.progress() as progress:
        result = bench(arguments.what, arguments.output, settings, progress)
    session.emit(result, bench_table(result))
    return ExitStatus.PARTIAL if result.failed else ExitStatus.DONE
