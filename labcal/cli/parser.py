"""argparse as labcal uses it: errors are raised, names are mended, every help ends with an example."""

import argparse
from argparse import Namespace
from collections.abc import Callable, Iterable
from difflib import get_close_matches
from textwrap import fill
from typing import NoReturn

from labcal.cli.session import Session
from labcal.cli.status import ExitStatus
from labcal.errors import InputError

Run = Callable[[Namespace, Session], ExitStatus]
"""The work of a command with its arguments."""


class UsageError(InputError):
    """Arguments that make no sense."""


_WIDTH = 79


class Parser(argparse.ArgumentParser):
    """A parser that raises :class:`UsageError` and offers the nearest name for a misspelled one."""

    def __init__(
        self, *, prog: str | None = None, description: str | None = None, epilog: str | None = None
    ) -> None:
        super().__init__(
            prog=prog,
            description=None if description is None else fill(description, _WIDTH),
            epilog=epilog,
            formatter_class=argparse.RawDescriptionHelpFormatter,
            allow_abbrev=False,  # an abbreviation breaks when a later version adds an option
        )

    def error(self, message: str) -> NoReturn:
        """Raise instead of leaving the program."""
        mark = "" if message.endswith("?") else "."
        sentence = f"{message[:1].upper()}{message[1:]}{mark}"
        raise UsageError(f"{sentence} '{self.prog} --help' explains the command.")

    def parse_known_args(self, args=None, namespace=None):  # type: ignore[no-untyped-def]  # noqa: ANN001, ANN201 - the overloads are argparse's
        """Parse as argparse does, and offer the nearest option for one that is not known.

        What follows an option that takes a value is its value, also where it begins with a hyphen.
        """
        words = None if args is None else self._with_values(list(args))
        found, extra = super().parse_known_args(words, namespace)
        for word in extra:
            if word.startswith("--"):
                given = word.partition("=")[0]
                self.error(f"there is no option {given}" + _hint(given, self._option_string_actions))
        return found, extra

    def _with_values(self, words: list[str]) -> list[str]:
        """Join values that begin with a hyphen to the long options before them (``--cameras=-l=left``)."""
        joined: list[str] = []
        for word in words:
            action = self._option_string_actions.get(joined[-1]) if joined else None
            takes = action is not None and action.nargs is None and joined[-1].startswith("--")
            option = word.partition("=")[0] in self._option_string_actions
            if takes and word.startswith("-") and not option:
                joined[-1] += f"={word}"
            else:
                joined.append(word)
        return joined

    def _check_value(self, action: argparse.Action, value: object) -> None:
        """Refuse what is not among the choices, and offer the nearest one."""
        if action.choices is not None and value not in action.choices:
            names = [str(choice) for choice in action.choices]
            known = f"'{value}' is not one of {', '.join(names)}"
            raise argparse.ArgumentError(action, known + _hint(str(value), names))


def _hint(given: str, names: Iterable[str]) -> str:
    """Return the nearest name as a question, or nothing."""
    nearest = get_close_matches(given, list(names), n=1, cutoff=0.6)
    return f"; did you mean '{nearest[0]}'?" if nearest else ""


class CommandGroup:
    """The commands under one parser."""

    def __init__(self, parser: Parser) -> None:
        self._commands = parser.add_subparsers(
            title="commands", metavar="COMMAND", required=True, parser_class=Parser
        )

    def name(self, name: str, summary: str) -> None:
        """List a command in the help without its arguments."""
        self._commands.add_parser(name, help=summary)

    def add(self, name: str, run: Run, description: str, *, example: str) -> Parser:
        """Return the parser of a command that ``run`` carries out; it has ``--json`` and ``--quiet``."""
        parser: Parser = self._commands.add_parser(
            name, help=description, description=description, epilog=f"example:\n  {example}"
        )
        parser.set_defaults(run=run)
        parser.add_argument("--json", action="store_true", help="one JSON document on stdout")
        parser.add_argument("--quiet", action="store_true", help="no messages and no progress bar")
        return parser

    def add_group(self, name: str, description: str, *, example: str) -> "CommandGroup":
        """Return the group of a command that has commands of its own."""
        parser: Parser = self._commands.add_parser(
            name, help=description, description=description, epilog=f"example:\n  {example}"
        )
        return CommandGroup(parser)
