"""Options that several commands share, and checked kinds of values."""

import argparse
from pathlib import Path

from labcal.errors import InputError
from labcal.run.decimal_words import decimal
from labcal.run.machine import usable_cores

_OTHER_NAMES = {"source": "from", "wanted": "to"}
"""Of options, by where `labcal convert` keeps their values."""


def add_output(parser: argparse.ArgumentParser, metavar: str, help_text: str) -> None:
    """Add ``-o`` (as ``arguments.output``, a path) and ``--force``."""
    parser.add_argument("-o", "--output", type=Path, required=True, metavar=metavar, help=help_text)
    parser.add_argument("--force", action="store_true", help="replace what labcal made there")


def add_pictures(parser: argparse.ArgumentParser) -> None:
    """Add the arguments of pictures: the pictures, ``--target``, ``--cameras``, ``--raw``."""
    parser.add_argument(
        "pictures", nargs="+", metavar="SHOOT-or-IMAGES", help="one shoot, or pictures and folders"
    )
    add_targets(parser)
    add_cameras(parser)


class TogetherAction(argparse.Action):
    """An option that may be given several times: its values are a list then."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,  # noqa: ARG002 -- argparse's
        namespace: argparse.Namespace,
        values: object,
        option_string: str | None = None,  # noqa: ARG002 -- argparse's
    ) -> None:
        """Store a value beside those before it."""
        before = getattr(namespace, self.dest)
        earlier = [] if before is None else before if isinstance(before, list) else [before]
        setattr(namespace, self.dest, [*earlier, values] if earlier else values)


class OnceAction(argparse.Action):
    """An option that may be given once."""

    def __call__(
        self,
        parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        option_string: str | None = None,
    ) -> None:
        """Store the value; raise where there is one."""
        before = getattr(namespace, self.dest)
        if before is not None:
            parser.error(
                f"{option_string} is given twice, as '{before}' and '{values}'; this command takes one "
                "(boards side by side are for detect, inspect, calibrate, check, fit, reconstruct, evaluate "
                "and capture)"
            )
        setattr(namespace, self.dest, values)


def add_targets(parser: argparse.ArgumentParser) -> None:
    """Add ``--target``, which may be given once for each of several boards in the same pictures."""
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=TogetherAction,
        help="the target; a shoot brings its own, and so does a print with a code. Given several times: "
        "boards side by side, fixed to one plate",
    )


def add_target_and_cameras(parser: argparse.ArgumentParser) -> None:
    """Add what pictures are of, who took them, and their form: ``--target``, ``--cameras``, ``--raw``."""
    parser.add_argument(
        "--target",
        metavar="NAME",
        action=OnceAction,
        help="the target; a shoot brings its own, and so does a print with a code",
    )
    add_cameras(parser)


def add_cameras(parser: argparse.ArgumentParser, of: str = "loose pictures") -> None:
    """Add ``--cameras`` and ``--raw``, which :func:`labcal.pipeline.open_pictures` takes.

    Parameters
    ----------
    parser : ArgumentParser
    of : str
        The pictures that they are for.
    """
    parser.add_argument(
        "--cameras",
        metavar="NAMES",
        help=f"cameras of {of} by the end of the name, '_0=left,_1=right', or by a pattern: "
        "'left*=left,right*=right', 'L/*=left,R/*=right', or by one with named parts: "
        "'shot_{view}_cam{camera}', '{camera}/{view}', or by lists of pictures, whose lines are the views, "
        "folders or forms of names: 'left=left.txt,right=right.txt', 'left=A/,right=B/', "
        "'left=A/L_*.png,right=A/R_*.png'; '*=camera' states that one camera took all",
    )
    parser.add_argument(
        "--raw",
        metavar="FORMAT",
        help=f"pixel format of {of} that hold a Bayer mosaic or have no header, with the size of these: "
        "'BayerRG8', 'Mono12p:1280x1024' (GenICam's names)",
    )


def add_page(parser: argparse.ArgumentParser) -> None:
    """Add ``--page`` (as ``arguments.page``), which :func:`labcal.cli.page.asked_page` reads."""
    parser.add_argument(
        "--page",
        type=Path,
        metavar="FILE.html",
        help="write a page to look at: a verdict in one sentence, figures, a 3-D view; it needs nothing "
        "beside it and fetches nothing",
    )


def add_detector_settings(parser: argparse.ArgumentParser) -> None:
    """Add ``--set`` (as ``arguments.changes``), which `labcal.detect.settings.detect_settings` reads."""
    parser.add_argument(
        "--set",
        action="append",
        default=[],
        metavar="detect.NAME=value",
        dest="changes",
        help="change a setting of the detector: --set detect.edge.max_iterations=20 (names, units and "
        "effects: docs/reference/settings.md)",
    )


def add_hold_out(parser: argparse.ArgumentParser) -> None:
    """Add ``--hold-out``, which :func:`labcal.correspond.view_roles.parse_hold_out` reads."""
    parser.add_argument(
        "--hold-out",
        metavar="N-or-VIEW[,VIEW]-or-none",
        help="of a target in the hand: leave views out, so many or those named, for 'labcal evaluate'; none: "
        "'calibrate' uses the test views of a shoot, too",
    )


class _Noted(argparse.Action):
    """Stores a value and, as ``NAME_given``, that a person gave it: the default does for every case."""

    def __call__(
        self,
        _parser: argparse.ArgumentParser,
        namespace: argparse.Namespace,
        values: object,
        _option: str | None = None,
    ) -> None:
        setattr(namespace, self.dest, values)
        setattr(namespace, f"{self.dest}_given", True)


def refuse_option(arguments: argparse.Namespace, name: str, why: str) -> None:
    """Raise where an option is given that would be dropped.

    Parameters
    ----------
    arguments : Namespace
    name : str
        Where its value stands among the arguments.
    why : str
        The use of the option, for people; begins with a verb.

    Raises
    ------
    InputError
        It is given.
    """
    given = getattr(arguments, f"{name}_given", getattr(arguments, name) not in (None, False))
    if given:
        option = _OTHER_NAMES.get(name, name).replace("_", "-")
        raise InputError(f"--{option} {why}. Leave it out.")


def add_seed(parser: argparse.ArgumentParser) -> None:
    """Add ``--seed``, 0 where not given."""
    parser.set_defaults(seed_given=False)
    parser.add_argument(
        "--seed",
        action=_Noted,
        type=whole_number,
        default=0,
        metavar="S",
        help="seed of all random numbers (default 0)",
    )


def add_workers(parser: argparse.ArgumentParser) -> None:
    """Add ``--workers``, all cores this process may use where not given."""
    parser.set_defaults(workers_given=False)
    parser.add_argument(
        "--workers",
        action=_Noted,
        type=positive_number,
        default=usable_cores(),
        metavar="N",
        help="processes at work (default %(default)s, the cores here); the results are the same for any. "
        "With 1 all is done in the program itself, which a picture that makes a library crash would end",
    )


def add_scheduler(parser: argparse.ArgumentParser, cases: str) -> None:
    """Add ``--scheduler``.

    Parameters
    ----------
    parser : ArgumentParser
    cases : str
        The cases that the cluster does, in the plural.
    """
    parser.add_argument(
        "--scheduler",
        metavar="ADDRESS",
        help=f"do the {cases} on a Dask cluster: tcp://HOST:PORT of its scheduler, or 'local' for a cluster "
        "of processes of this machine; the results are the same",
    )


_MOST = 2**63 - 1
"""`MOST_NUMBER` of `labcal.bounds`, which takes pydantic to import."""


def whole_number(text: str) -> int:
    """Read an integer from 0 up."""
    return _integer(text, least=0)


def positive_number(text: str) -> int:
    """Read an integer from 1 up."""
    return _integer(text, least=1)


def _integer(text: str, *, least: int) -> int:
    """Read an integer not below `least`."""
    try:
        decimal(text)  # Python alone takes 1_0 for 10, and digits of other scripts
        number = int(text)
    except ValueError:
        number = None
    if number is None or not least <= number <= _MOST:
        raise argparse.ArgumentTypeError(f"'{text}' should be a whole number, at least {least}")
    return number
