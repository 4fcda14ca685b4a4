"""The page that a command is asked for with ``--page``."""

from argparse import Namespace
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

from labcal.cli.option_words import in_options
from labcal.cli.session import Session

if TYPE_CHECKING:
    from labcal.report.page.output import PageOutput


def asked_page(
    arguments: Namespace, session: Session, inputs: Sequence[str | Path | None]
) -> "PageOutput | None":
    """Return the page that is asked for, which speaks of options and says the command; else None.

    Parameters
    ----------
    arguments : Namespace
        With ``page`` and, of commands that write something else, too, ``force``.
    session : Session
    inputs : sequence of str, path or None
        What the command was given; files among them are listed in the page.
    """
    from labcal.report.page.output import PageOutput

    if arguments.page is None:
        return None
    read = tuple(one for one in inputs if one is not None)
    return PageOutput(arguments.page, arguments.force, session.command, in_options, read)
