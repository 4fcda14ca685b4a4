"""``labcal bench``: benchmarks, every figure against its limit."""

from argparse import Namespace

from labcal.cli.options import add_output, add_seed
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
        "what", choices=("render",), help="render: the rendered laboratory's own error and cost"
    )
    parser.add_argument(
        "--quick", action="store_true", help="fewer pictures; some ten minutes in place of an hour"
    )
    add_output(parser, "DIR", "folder to appear")
    add_seed(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Measure and show the table."""
    from labcal.experiments.bench_render.bench import BenchSettings, bench_render
    from labcal.report.bench import bench_table

    settings = BenchSettings(quick=arguments.quick, seed=arguments.seed, force=arguments.force)
    with session.progress() as progress:
        result = bench_render(arguments.output, settings, progress)
    session.emit(result, bench_table(result))
    return ExitStatus.PARTIAL if result.failed else ExitStatus.DONE
