"""``labcal reproduce``: the paper's rows and claims, and two studies about them."""

from argparse import Namespace

from labcal.cli.options import (
    add_output,
    add_scheduler,
    add_seed,
    add_workers,
    positive_number,
    refuse_option,
)
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "reproduce",
        run,
        "Reproduce the paper, its 22 rows and 8 claims or some of them, and write results.json and a page.",
        example="labcal reproduce 01 13 C8 --quick -o out/quick",
    )
    parser.add_argument(
        "experiments",
        nargs="*",
        metavar="ROW|CLAIM|STUDY",
        help=(
            "numbers of rows, claims (C1 to C8), 'study' (neurons and layers), 'explanations' (of figures "
            "of rows 17 to 23); all where none is given"
        ),
    )
    parser.add_argument(
        "--quick", action="store_true", help="fewer rays a pixel, fewer epochs, one seed; the page states it"
    )
    parser.add_argument(
        "--seeds",
        type=positive_number,
        metavar="N",
        help="runs of rows and studies, for medians (10, or 1 with --quick); claims have those of their plan",
    )
    add_output(parser, "DIR", "folder to appear")
    add_seed(parser)
    add_workers(parser)
    add_scheduler(parser, "training runs")


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Reproduce and show the table."""
    from rich.console import Group, RenderableType

    from labcal.pipeline import ReproduceSettings, reproduce
    from labcal.report.claims_table import claims_table
    from labcal.report.explanations_table import explanations_table
    from labcal.report.reproduction_table import reproduction_table
    from labcal.report.study_table import study_table

    if arguments.scheduler not in (None, "local"):
        refuse_option(arguments, "workers", "is for processes of this machine; a cluster has its own workers")
    settings = ReproduceSettings(
        experiments=tuple(arguments.experiments),
        quick=arguments.quick,
        seeds=arguments.seeds,
        seed=arguments.seed,
        workers=arguments.workers,
        scheduler=arguments.scheduler,
        force=arguments.force,
    )
    with session.progress() as progress:
        result = reproduce(arguments.output, settings, progress)
    tables: list[RenderableType] = [reproduction_table(result)] if result.rows else []
    tables += [claims_table(result.claims)] if result.claims else []
    tables += [study_table(result.study)] if result.study else []
    tables += [explanations_table(result.explanations)] if result.explanations else []
    session.emit(result, Group(*tables))
    session.say(f"The page: {arguments.output / 'index.html'}")
    return ExitStatus.DONE
