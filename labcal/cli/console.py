"""Text and tables as a stream shows them."""

from collections.abc import Iterable
from typing import Any

from rich.console import Console, ConsoleOptions, RenderableType
from rich.segment import Segment
from rich.text import Text

from labcal.cli.option_words import in_options
from labcal.cli.streams import Stream
from labcal.wording import printable

_WIDTH_OF_A_FILE = 200
"""Columns for tables where no terminal states its width."""


class PlainConsole(Console):
    """A console that writes out control characters of what it is given to show, in cells of tables, too.

    Names come from files, and a name may hold what moves a terminal's cursor.
    """

    def render(self, renderable: RenderableType, options: ConsoleOptions | None = None) -> Iterable[Segment]:
        """Return the pieces to show; the console's own control codes are none of their text."""
        for text, style, control in super().render(renderable, options):
            yield Segment(text if control else printable(text), style, control)

    def render_str(self, text: str, **how: Any) -> Text:  # noqa: ANN401 -- rich's own options
        """Return a text, such as a cell, so that its width is that of what is shown."""
        return super().render_str(printable(in_options(text)), **how)


def console_for(stream: Stream) -> Console:
    """Return a console that prints text as it is."""
    width = None if stream.isatty() else _WIDTH_OF_A_FILE
    return PlainConsole(file=stream, markup=False, highlight=False, emoji=False, width=width)


def rendered(content: object, stream: Stream) -> str:
    """Return a text with its lines unbroken, or a table within the width, as `stream` shows it."""
    console = console_for(stream)
    with console.capture() as captured:
        # Before rich breaks it into lines, since it drops some control characters by itself.
        text = printable(in_options(content)) if isinstance(content, str) else content
        console.print(text, soft_wrap=isinstance(content, str))
    return captured.get()
