"""The study of neurons and layers, as a section of a page."""

from collections.abc import Sequence

from labcal.report.page.chart import Chart
from labcal.report.page.document import Section
from labcal.report.page.download import Download
from labcal.report.page.prose import Prose, Tone
from labcal.report.page.written import Written
from labcal.report.study import StudyCell
from labcal.report.study_figure import study_figure
from labcal.report.study_words import goal_words, study_sentences
from labcal.run.tables import table_text

_HOW = (
    "The paper tried several numbers of neurons and layers and shows none of it. Neurons are counted over "
    "all hidden layers, which share them equally. Scored on points that were not trained on."
)
_CAPTION = "Medians over the seeds; bands are their range."
_HEADER = (
    "exp", "data", "points", "goal", "network", "layers", "neurons", "parameters", "seeds", "reached",
    "rmse_mm", "mean_signed_m", "epochs", "seconds",
)  # fmt: skip


def study_section(cells: Sequence[StudyCell]) -> Section:
    """Return the section: the best networks in words, the figure, every network.

    Parameters
    ----------
    cells : sequence of StudyCell
        Of every network and kind of data; at least one.
    """
    lines = [[getattr(cell, name) for name in _HEADER] for cell in cells]
    data = Download("study.csv", table_text(_HEADER, lines))
    every = Written("study.html.jinja", {"cells": cells, "goal_words": goal_words})
    return Section(
        "Neurons and layers",
        [
            Prose((_HOW,), Tone.QUIET),
            Prose(tuple(study_sentences(cells))),
            Chart("study", study_figure(cells), _CAPTION, data),
            every,
        ],
    )
