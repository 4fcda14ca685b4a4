"""``labcal rehearse``: the errors to expect of a rig before anything is bought or printed."""

from argparse import Namespace

from labcal.cli.options import add_output, add_seed, add_workers, positive_number
from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    parser = commands.add(
        "rehearse",
        run,
        "Forecast the errors of a planned rig before anything is bought or printed, and what limits them.",
        example="labcal rehearse webcams -o rehearsal\n"
        "  labcal rehearse my-rig.yaml -o rehearsal --confirm 3",
    )
    parser.add_argument(
        "plan", metavar="RIG.yaml", help="name of a plan that labcal ships, or path of a YAML file"
    )
    add_output(parser, "DIR", "folder to appear: page, map, recommended poses, planned cameras")
    parser.add_argument(
        "--confirm",
        nargs="?",
        type=positive_number,
        const=1,
        default=0,
        metavar="SETS",
        help="render so many sets of the views (1), calibrate from each, and compare the errors with the "
        "forecast: minutes a set; the result says how many sets tell something",
    )
    parser.add_argument(
        "--spp",
        type=positive_number,
        default=64,
        metavar="N",
        help="rays a pixel with --confirm (default 64; fewer add noise of their own)",
    )
    add_seed(parser)
    add_workers(parser)


def run(arguments: Namespace, session: Session) -> ExitStatus:
    """Rehearse the plan."""
    from labcal.pipeline import RehearseSettings, rehearse
    from labcal.report.rehearsal_result import rehearse_result
    from labcal.report.rehearsal_words import rehearse_table
    from labcal.run.claims import FolderOutput, claim_outputs

    claim_outputs([FolderOutput(arguments.output)], [arguments.plan], force=arguments.force)
    settings = RehearseSettings(
        seed=arguments.seed,
        confirm=arguments.confirm,
        spp=arguments.spp,
        workers=arguments.workers,
        force=arguments.force,
    )
    with session.progress() as progress:
        found = rehearse(arguments.plan, arguments.output, settings, progress)
    for warning in found.warnings:
        session.warn(warning)
    result = rehearse_result(arguments.output, found)
    session.emit(result, rehearse_table(result))
    failed = found.confirmation is not None and not found.confirmation.holds
    return ExitStatus.PARTIAL if failed else ExitStatus.DONE
