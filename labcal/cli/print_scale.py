"""``--print-scale``: the measured ruler of a print, entered once and stored where later commands find it."""

from argparse import ArgumentParser, Namespace
from typing import TYPE_CHECKING

from labcal.cli.session import Session

if TYPE_CHECKING:
    from labcal.shoot.dataset import Shoot
    from labcal.targets.catalogue import AnyTarget


def add_print_scale(parser: ArgumentParser, stored: str) -> None:
    """Add ``--print-scale`` (as ``arguments.print_scale``).

    Parameters
    ----------
    parser : ArgumentParser
    stored : str
        Where the command stores it, for people.
    """
    parser.add_argument(
        "--print-scale",
        metavar="MEASURED/NOMINAL",
        help="measured over nominal length of the print's ruler, as 99.8/100; for x and y apart "
        f"99.8/100,100.1/100. Stated once: {stored}",
    )


def scaled_target(target: "AnyTarget", arguments: Namespace) -> "AnyTarget":
    """Return the target as its print is, where the option is given.

    Raises
    ------
    InputError
        Its scale is stated already, or what is given is none.
    """
    from labcal.targets.print_scale import as_printed

    return as_printed(target, arguments.print_scale)


def store_scale(shoot: "Shoot", target: "AnyTarget", session: Session) -> "Shoot":
    """Return a shoot with a target whose scale is stated, and write so into its manifest.

    Raises
    ------
    OutputError
        The manifest cannot be written.
    """
    from labcal.shoot.dataset import MANIFEST, write_manifest

    made = shoot.showing(target)
    write_manifest(made.folder, made.manifest)
    session.say(f"the print's scale is stored in {made.folder / MANIFEST}; later commands find it there")
    return made
