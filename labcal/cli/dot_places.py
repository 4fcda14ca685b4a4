"""Options of commands that may free the dots of a target."""

from argparse import ArgumentParser, Namespace

from labcal.calibrate.dot_treatment import DotTreatment


def add_dot_places(parser: ArgumentParser, note: str) -> None:
    """Add ``--free-dots`` and ``--keep-dots``; `note` ends the help of the first."""
    either = parser.add_mutually_exclusive_group()
    either.add_argument(
        "--free-dots",
        action="store_true",
        help="estimate where each dot is on the print, too; without either option this is done where "
        f"held-out views show an uneven print{note}",
    )
    either.add_argument(
        "--keep-dots", action="store_true", help="take the dots as declared, whatever held-out views show"
    )


def dot_treatment(arguments: Namespace) -> DotTreatment:
    """Return the treatment that the options ask for."""
    if arguments.free_dots:
        return DotTreatment.FREED
    return DotTreatment.DECLARED if arguments.keep_dots else DotTreatment.AUTO
