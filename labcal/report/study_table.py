"""The study of neurons and layers in a terminal."""

from collections.abc import Sequence

from rich.box import SIMPLE_HEAD
from rich.console import Group, RenderableType
from rich.table import Column, Table
from rich.text import Text

from labcal.report.figures_text import epochs, millimetres
from labcal.report.study import StudyCell
from labcal.report.study_words import goal_words, of_each_data, range_words, study_sentences

_NOTE = (
    "Neurons of all hidden layers together, shared equally. Medians over the seeds, with their range; scored "
    "on points that were not trained on."
)


def study_table(cells: Sequence[StudyCell]) -> RenderableType:
    """Return every network by its data, and the best in words; a terminal of 80 columns holds it."""
    parts: list[RenderableType] = [Text("Neurons and layers", style="bold")]
    for data, group in of_each_data(cells).items():
        table = Table(
            Column("network", no_wrap=True),
            Column("weights", justify="right"),
            Column("RMS, mm", justify="right", no_wrap=True),
            Column("epochs", justify="right", no_wrap=True),
            Column("goal reached", justify="right"),
            Column("s", justify="right"),
            box=SIMPLE_HEAD, pad_edge=False, show_edge=False, padding=(0, 1, 0, 0),
        )  # fmt: skip
        for cell in group:
            table.add_row(
                Text(cell.network),
                str(cell.parameters),
                range_words(*map(millimetres, (cell.rmse_mm, *cell.rmse_range_mm))),
                range_words(*map(epochs, (cell.epochs, *cell.epochs_range))),
                goal_words(cell),
                f"{cell.seconds:.2g}",
            )
        parts += [Text(f"{data}, {group[0].points} points, goal {group[0].goal:g}"), table, Text("")]
    return Group(*parts, *(Text(f"{sentence}\n") for sentence in study_sentences(cells)), Text(_NOTE))
