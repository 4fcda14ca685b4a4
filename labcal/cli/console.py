"""Text and tables as a stream shows them."""

from rich.console import Console

from labcal.cli.streams import Stream

_WIDTH_OF_A_FILE = 200
"""Columns for tables where no terminal says how wide it is."""


def console_for(stream: Stream) -> Console:
    """Return a console that prints text as it is."""
    width = None if stream.isatty() else _WIDTH_OF_A_FILE
    return Console(file=stream, markup=False, highlight=False, emoji=False, width=width)


def rendered(content: object, stream: Stream) -> str:
    """Return a text with its lines unbroken, or a table within the width, as `stream` shows it."""
    console = console_for(stream)
    with console.capture() as captured:
        console.print(content, soft_wrap=isinstance(content, str))
    return captured.get()
