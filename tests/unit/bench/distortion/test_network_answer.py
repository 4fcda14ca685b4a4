"""The answer to "should I use a network?", and the winners, on results with a known answer."""

import time
from collections.abc import Callable
from dataclasses import replace

from labcal.bench.distortion.case import Cell, Layout
from labcal.bench.distortion.cell_summary import CellSummary
from labcal.bench.distortion.network_answer import network_answer
from labcal.bench.distortion.winners import winners

Make = Callable[..., CellSummary]
WATER = Cell("water", 0.5, 0.1, 140, Layout.PLANES)
BROWN = replace(WATER, family="brown")
BAD, SAME, GOOD = (3.0, 3.0, 3.0), (1.0, 1.2, 0.9), (0.5, 0.6, 0.7)
REFERENCE = (1.0, 1.0, 1.0)


def answered(summary: Make, water: tuple[float, ...], brown: tuple[float, ...]) -> str:
    cells = [summary("hybrid", REFERENCE, cell=cell) for cell in (WATER, BROWN)]
    cells += [summary("mlp", water, cell=WATER), summary("mlp", brown, cell=BROWN)]
    return network_answer(cells)[0]


def test_the_answer_follows_the_results(summary: Make) -> None:
    assert answered(summary, BAD, BAD).startswith("No: of 2 cells")
    assert answered(summary, SAME, SAME).startswith("No: of 2 cells")
    assert answered(summary, GOOD, GOOD).startswith("Yes: of 2 cells")
    assert answered(summary, GOOD, BAD).startswith("Only where it is better: water 0.5: of 2 cells")
    assert "larger in 1; its error is 1.8 times" in answered(summary, GOOD, BAD)


def test_the_best_network_is_compared(summary: Make) -> None:
    cells = [summary("hybrid", REFERENCE), summary("mlp", BAD), summary("mlp-bayes", GOOD)]
    assert network_answer(cells)[0].startswith("Yes")


def test_it_is_said_beside_the_bundle_adjustment(summary: Make) -> None:
    cells = [summary("hybrid", (0.1, 0.1, 0.1)), summary("bundle", REFERENCE), summary("mlp", GOOD)]
    answer = network_answer(cells)
    assert answer[0].startswith("No")
    assert "is better in 1 of 1 cell with distortion (water 0.5)" in answer[1]


def test_without_networks_or_without_others_there_is_no_answer(summary: Make) -> None:
    assert network_answer([summary("hybrid", REFERENCE)]) == []
    assert network_answer([summary("mlp", REFERENCE)]) == []


def test_the_winner_wins_in_pairs_over_the_seeds(summary: Make) -> None:
    hybrid, mlp = summary("hybrid", (1.0, 4.0, 1.0)), summary("mlp", (2.0, 2.0, 3.0))
    (won,) = winners([mlp, hybrid, summary("dlt", (), float("nan"), reasons=("why",))])
    assert (won.best, won.second, won.over_oracle) == ("hybrid", "mlp", 1.0)
    assert (won.second_over_best, won.seeds_won, won.seeds) == (2.0, 2, 3)


def test_the_answer_takes_time_in_proportion_to_the_cells(summary: Make) -> None:
    """Of three thousand cells, half of the full plan; by pairs of cells they would take half a minute."""
    cells = [replace(WATER, points=number) for number in range(3000)]
    found = [
        summary(method, ratios, cell=cell)
        for cell in cells
        for method, ratios in (("bundle", REFERENCE), ("mlp", BAD))
    ]
    began = time.process_time()
    assert network_answer(found)[0].startswith("No: of 3000 cells")
    assert time.process_time() - began < 3.0
