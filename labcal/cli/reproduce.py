"""``labcal reproduce``: the paper's rows."""

from argparse import Namespace

from labcal.cli.options import add_output, add_seed, add_workers, positive_number
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "reproduce",
        run,
        "Reproduce the experiments of the paper, all 22 rows or some, and write results.json and a page.",
        example="labcal reproduce 01 13 21 --quick -o out/quick",
    )
    parser.add_argument("rows", nargs="*", metavar="ROW", help="numbers of rows; all where none is given")
    parser.add_argument(
        "--quick", action="store_true", help="fewer rays a pixel, fewer epochs, one seed; the page states it"
    )
    parser.add_argument(
        "--seeds",
        type=positive_number,
        metavar="N",
        help="runs of every row, for medians (5, or 1 with --quick)",
    )
    add_output(parser, "DIR", "folder to appear")
    add_seed(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Reproduce and show the table."""
    from labcal.pipeline import ReproduceSettings, reproduce
    from labcal.report.reproduction_table import reproduction_table

    settings = ReproduceSettings(
        rows=arguments.rows,
        quick=arguments.quick,
        seeds=arguments.seeds,
        seed=arguments.seed,
        workers=arguments.workers,
        force=arguments.force,
    )
    with session.progress() as progress:
        result = reproduce(arguments.output, settings, progress)
    session.emit(result, reproduction_table(result))
    session.say(f"The page: {arguments.output / 'index.html'}")
    return ExitStatus.DONE
