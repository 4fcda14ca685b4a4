"""The study of neurons and layers in words, in a terminal, and as a figure."""

from pathlib import Path

import pytest
from rich.console import Console

from labcal.report.reproduction import Reproduction
from labcal.report.reproduction_page import reproduction_page
from labcal.report.study import StudyCell
from labcal.report.study_figure import study_figure
from labcal.report.study_table import study_table
from labcal.report.study_words import study_sentences


def cell(network: str, rmse_mm: float, data: str = "simulated, plane", **changes: float) -> StudyCell:
    hidden = [int(count) for count in network.split("-")[:-1]]
    values = {
        "exp": "01", "data": data, "points": 300, "goal": 1e-7, "layers": len(hidden), "neurons": sum(hidden),
        "network": network, "parameters": 83, "seeds": 3, "reached": 2, "rmse_mm": rmse_mm,
        "rmse_range_mm": (rmse_mm / 2, rmse_mm * 2), "mean_signed_m": 1e-5,
        "mean_signed_range_m": (-1e-5, 2e-5),
        "epochs": 9.0, "epochs_range": (8.0, 12.0), "seconds": 0.25, "seconds_range": (0.2, 0.3),
    }  # fmt: skip
    return StudyCell(**{**values, **changes})


CELLS = [
    cell("3", 18.0), cell("10-3", 0.121), cell("40-3", 0.1), cell("5-5-3", 0.3), cell("20-20-3", 0.2),
    cell("3", 60.0, "simulated, volume"), cell("10-3", 7.0, "simulated, volume"),
]  # fmt: skip


def test_sentences_name_the_best_of_each_depth_and_the_smallest_that_is_as_good() -> None:
    plane, volume = study_sentences(CELLS)
    assert plane == (
        "Simulated, plane: Without a hidden layer 18.0 mm RMS. Least RMS error with one hidden layer "
        "0.100 mm (network 40-3), two 0.200 mm (network 20-20-3). The fewest neurons within 25% of the "
        "least error: 10 in 1 layer."
    )
    assert "60.0 mm" in volume
    assert volume.endswith("10 in 1 layer.")


def test_with_noise_no_hidden_layer_may_be_as_good() -> None:
    (noisy,) = study_sentences([cell("3", 12.3), cell("10-3", 11.5)])
    assert noisy.endswith("The fewest neurons within 25% of the least error: none, that is, no hidden layer.")


def test_no_study_has_no_words() -> None:
    assert study_sentences([]) == []


@pytest.mark.parametrize("width", [80, 120])
def test_every_network_stands_in_the_terminal(width: int) -> None:
    console = Console(width=width, record=True)
    console.print(study_table(CELLS))
    text = console.export_text()
    assert all(len(line.rstrip()) <= width for line in text.splitlines())
    for words in (
        "20-20-3",
        "0.200 (0.100 to 0.400)",
        "9 (8 to 12)",
        "2 of 3",
        "goal 1e-07",
        "Neurons of all",
    ):
        assert words in text


def test_the_study_is_a_section_of_the_page_with_its_numbers(made_up: Reproduction, tmp_path: Path) -> None:
    page = reproduction_page(made_up.model_copy(update={"study": tuple(CELLS)}), tmp_path)
    for words in (
        *study_sentences(CELLS),
        'id="neurons-and-layers"',
        "study.csv",
        "20-20-3",
        " study --quick",
    ):
        assert words in page
    alone = reproduction_page(made_up.model_copy(update={"study": tuple(CELLS), "rows": ()}), tmp_path)
    assert "Every row</h2>" in page
    assert "Every row</h2>" not in alone
    assert 'id="neurons-and-layers"' in alone
    assert 'id="neurons-and-layers"' not in reproduction_page(made_up, tmp_path)


def test_the_figure_is_the_same_twice_and_shows_each_depth() -> None:
    figure = study_figure(CELLS)
    assert figure == study_figure(CELLS)
    for words in ("no hidden layer", "1 layer", "2 layers", "simulated, volume", "RMS error, mm", "seconds"):
        assert words in figure
    assert "3 layers" not in figure
    assert study_figure([cell("5-3", 1.0)]) != study_figure([cell("5-3", 2.0), cell("10-3", 1.0)])
