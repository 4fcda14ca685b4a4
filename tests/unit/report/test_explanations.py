"""The words about what would explain rows 17 to 23, in a terminal and on the page."""

from math import nan
from pathlib import Path

import pytest
from rich.console import Console

from labcal.report.explanations import (
    CauseResult,
    DivisorResult,
    ExplainedRow,
    Explanations,
    QuotientRow,
)
from labcal.report.explanations_table import explanations_table
from labcal.report.explanations_words import (
    cause_sentences,
    divisor_sentences,
    size_words,
    summary_sentences,
)
from labcal.report.figure_readings import FigureReading
from labcal.report.reproduction import Reproduction
from labcal.report.reproduction_page import reproduction_page
from labcal.run.json_text import to_json

SIGNED, COORDINATE = FigureReading


def row(exp: str, figure: FigureReading, size: float, **changes: object) -> ExplainedRow:
    values = {
        "exp": exp, "method": "mlp", "figure": figure, "paper_m": 0.02, "size": size,
        "size_range": (size / 2, size * 2), "solved": 5, "seeds": 5, "greatest_m": 0.05,
        "likely": 1 <= size <= 10, "also_gives": (),
    }  # fmt: skip
    return ExplainedRow.model_validate({**values, **changes})


HAND = CauseResult(
    cause="points picked by hand", words="Gaussian noise", unit="px", likely=(1.0, 10.0), greatest=100.0,
    rows=(
        row("21", SIGNED, nan, solved=0), row("22", SIGNED, nan, solved=2),
        row("21", COORDINATE, 12.7, also_gives=("23",)), row("22", COORDINATE, 0.57),
        row("22", COORDINATE, 3.0), row("23", COORDINATE, nan, solved=1),
    ),
)  # fmt: skip
FOUND = Explanations(
    causes=(HAND,),
    quotients=(
        QuotientRow(
            exp="21",
            figure=SIGNED,
            printed=-0.015,
            ours_mm=0.01,
            quotient_mm=0.67,
            quotient_range_mm=(0.1, 1.5),
        ),
    ),
    divisors=(
        DivisorResult(
            divisor="millimetre", least_mm=1, greatest_mm=1, mean_signed_rows=("21", "22"), coordinate_rows=()
        ),
        DivisorResult(
            divisor="a pixel", least_mm=0.9, greatest_mm=2.5, mean_signed_rows=("21",), coordinate_rows=()
        ),
    ),
)


def test_sentences_say_which_rows_a_cause_gives_and_that_none_is_a_result() -> None:
    signed, coordinate = cause_sentences(HAND)
    assert signed == "Read as mean signed error: no size up to 100 px gives any row."
    assert coordinate == (
        "Read as RMS error of a coordinate: row 21 at 13 px, 22 at 0.57 px; of a likely size (1 to 10 px): "
        "none. One size gives at most 2 of 3 rows (21, 23 at 13 px)."
    )


def with_rows(*rows: ExplainedRow) -> Explanations:
    return FOUND.model_copy(update={"causes": (HAND.model_copy(update={"rows": rows}),)})


def test_the_summary_says_whether_one_mistake_gives_all_rows() -> None:
    most, likely = summary_sentences(FOUND)
    assert most == (
        "No mistake of one size gives all 3 rows; at most rows 21, 23 (points picked by hand, "
        "13 px (6.3 to 25), figure read as RMS error of a coordinate)."
    )
    assert likely == (
        "Rows that a mistake of a likely size gives: points picked by hand, figure read as RMS error of a "
        "coordinate: 22. Rows that no likely size gives: 21, 23."
    )
    both = with_rows(row("21", SIGNED, 4.0, also_gives=("22",)), row("22", SIGNED, 5.0))
    common, likely = summary_sentences(both)
    assert common.startswith("One mistake of one size gives all rows: 21, 22 (")
    assert likely.endswith("mean signed error: 21, 22.")
    apart = with_rows(row("21", SIGNED, 40.0), row("22", SIGNED, 50.0))
    assert summary_sentences(apart) == [
        "No mistake of one size gives two of the 2 rows.",
        "No mistake of a likely size gives any row.",
    ]
    none = with_rows(row("21", SIGNED, nan))
    assert summary_sentences(none) == ["No mistake of any size that was tried gives any row."]


@pytest.mark.parametrize(
    ("given", "words"),
    [
        (row("21", SIGNED, 12.7), "13 px (6.3 to 25)"),
        (row("21", SIGNED, 4.0, size_range=(2.0, nan), solved=4), "4.0 px (2.0 to beyond)"),
        (row("21", SIGNED, nan, solved=0), "none up to 100 px"),
        (row("21", SIGNED, nan, solved=2), "none up to 100 px, 2 of 5 seeds"),
        (row("21", SIGNED, 4.0, seeds=1), "4.0 px"),
    ],
)
def test_sizes_in_words(given: ExplainedRow, words: str) -> None:
    assert size_words(given, HAND) == words


def test_the_divisor_of_most_rows_is_named() -> None:
    signed, coordinate = divisor_sentences(FOUND)
    assert signed.endswith("most rows, 2, are given by: millimetre (rows 21, 22).")
    assert coordinate.endswith("no unit and no length gives any row.")


def test_everything_stands_in_the_terminal() -> None:
    console = Console(width=80, record=True)
    console.print(explanations_table(FOUND))
    text = console.export_text()
    assert all(len(line.rstrip()) <= 80 for line in text.splitlines())
    for words in ("points picked by hand", "0.57 px", "none up to", "millimetre", "0.900 to 2.50"):
        assert words in text


def test_results_are_read_back_and_stand_on_the_page(made_up: Reproduction, tmp_path: Path) -> None:
    result = made_up.model_copy(update={"explanations": FOUND})
    again = Reproduction.model_validate_json(to_json(result))
    assert to_json(again) == to_json(result)
    page = reproduction_page(again, tmp_path)
    assert 'id="what-would-explain-rows-17-to-23"' in page
    for words in (
        *summary_sentences(FOUND),
        *cause_sentences(HAND),
        *divisor_sentences(FOUND),
        "0.670 (0.100 to 1.50)",
    ):
        assert words in page
    assert 'id="what-would-explain-rows-17-to-23"' not in reproduction_page(made_up, tmp_path)
