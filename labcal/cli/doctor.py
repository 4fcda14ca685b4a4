"""``labcal doctor``: what works on this machine, and what to install for the rest."""

from argparse import Namespace
from dataclasses import dataclass
from typing import TYPE_CHECKING

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus

if TYPE_CHECKING:
    from labcal.cli.health import Check


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    commands.add(
        "doctor",
        run,
        "Show what works on this machine and what to install for the rest. Status 0: all works; 1: not all.",
        example="labcal doctor --json",
    )


@dataclass(frozen=True)
class Diagnosis:
    """The JSON document of ``labcal doctor``."""

    ok: bool
    labcal: str
    checks: "list[Check]"


def run(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """Make every check and show the table."""
    from rich.table import Table

    from labcal import __version__
    from labcal.cli.health import all_checks

    checks = []
    with session.progress() as progress:
        planned = all_checks()
        progress.start("checking", len(planned))
        for make in planned:
            checks.append(make())
            progress.advance()
    table = Table("", "what", "found", "what to do", title=f"labcal {__version__}")
    for check in checks:
        table.add_row("ok" if check.ok else "NO", check.name, check.found or "-", check.advice or "")
    ok = all(check.ok for check in checks)
    session.emit(Diagnosis(ok, __version__, checks), table)
    return ExitStatus.DONE if ok else ExitStatus.PARTIAL
