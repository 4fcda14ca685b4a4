"""``labcal method``: estimators from pixels to points."""

from argparse import Namespace
from dataclasses import dataclass

from labcal.cli.parser import CommandGroup
from labcal.cli.session import Session
from labcal.cli.status import ExitStatus


def add_parser(commands: CommandGroup) -> None:
    """Describe the arguments."""
    method = commands.add_group("method", "List the methods.", example="labcal method list")
    method.add(
        "list",
        run_list,
        "List the methods of 'labcal fit', the one to begin with first, and what each needs.",
        example="labcal method list --json",
    )


@dataclass(frozen=True)
class MethodItem:
    """A method in the JSON document of ``labcal method list``."""

    method: str
    summary: str
    needs: str


@dataclass(frozen=True)
class MethodList:
    """The JSON document of ``labcal method list``."""

    methods: list[MethodItem]


def run_list(arguments: Namespace, session: Session) -> ExitStatus:  # noqa: ARG001 - it has no arguments
    """List the methods."""
    from rich.table import Table

    from labcal.estimators.registry import method_entries

    items = [MethodItem(name, entry.summary, entry.needs) for name, entry in method_entries().items()]
    table = Table(
        "method",
        "what it is",
        "what it needs",
        caption="One of your own: --method package.module:Class, a regressor as those of scikit-learn.",
        caption_justify="left",
    )
    table.columns[0].no_wrap = True
    for item in items:
        table.add_row(item.method, item.summary, item.needs)
    session.emit(MethodList(items), table)
    return ExitStatus.DONE
