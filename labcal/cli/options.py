"""Options that several commands share, and checked kinds of values."""

import argparse
from pathlib import Path

from labcal.run.machine import usable_cores


def add_output(parser: argparse.ArgumentParser, metavar: str, help_text: str) -> None:
    """Add ``-o`` (as ``arguments.output``, a path) and ``--force``."""
    parser.add_argument("-o", "--output", type=Path, required=True, metavar=metavar, help=help_text)
    parser.add_argument("--force", action="store_true", help="replace what labcal made there")


def add_pictures(parser: argparse.ArgumentParser) -> None:
    """Add what :func:`labcal.cli.inputs.pictures_and_target` reads: pictures, ``--target``, ``--cameras``."""
    parser.add_argument(
        "pictures", nargs="+", metavar="SHOOT-or-IMAGES", help="one shoot, or pictures and folders"
    )
    parser.add_argument("--target", metavar="NAME", help="the target; a shoot brings its own")
    parser.add_argument(
        "--cameras",
        metavar="ENDINGS",
        help="cameras of loose pictures by the end of the name: '_0=left,_1=right'",
    )


def add_seed(parser: argparse.ArgumentParser) -> None:
    """Add ``--seed``, 0 where not given."""
    parser.add_argument(
        "--seed", type=whole_number, default=0, metavar="S", help="seed of all random numbers (default 0)"
    )


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add ``--workers``, all cores this process may use where not given."""
    parser.add_argument(
        "--workers",
        type=positive_number,
        default=usable_cores(),
        metavar="N",
        help="processes at work (default %(default)s, the cores here); the results are the same for any",
    )


def whole_number(text: str) -> int:
    """Read an integer from 0 up."""
    return _integer(text, least=0)


def positive_number(text: str) -> int:
    """Read an integer from 1 up."""
    return _integer(text, least=1)


def _integer(text: str, *, least: int) -> int:
    """Read an integer not below `least`."""
    try:
        number = int(text)
    except ValueError:
        number = None
    if number is None or number < least:
        raise argparse.ArgumentTypeError(f"'{text}' should be a whole number, at least {least}")
    return number
