"""The table in the terminal: what stays at which width."""

import io

import pytest
from rich.console import Console

from labcal.report.reproduction import Reproduction
from labcal.report.reproduction_table import reproduction_table


def lines_of(result: Reproduction, width: int) -> list[str]:
    stream = io.StringIO()
    Console(file=stream, width=width, markup=False, highlight=False).print(reproduction_table(result))
    return [line.rstrip() for line in stream.getvalue().splitlines()]


def row_of(lines: list[str], exp: str) -> list[str]:
    return next(line for line in lines if line.startswith(exp)).split()


@pytest.mark.parametrize("width", [80, 100, 120, 200])
def test_every_row_takes_one_line_and_nothing_is_cut(made_up: Reproduction, width: int) -> None:
    lines = lines_of(made_up, width)
    assert all(len(line) <= width for line in lines)
    assert "…" not in "".join(lines)
    end = lines.index("")
    assert [line[:2] for line in lines[3:end]] == [f"{number:02}" for number in range(1, 24)]
    assert lines[3 + 15].endswith("not reported")


def test_80_columns_keep_the_telling_figures(made_up: Reproduction) -> None:
    lines = lines_of(made_up, 80)
    assert row_of(lines, "20") == [
        "20!", "NN", "50-3", "+0.01178", "-0.28720", "1253", "358", "58.9", "contradiction",
    ]  # fmt: skip
    assert row_of(lines, "22")[5] == "19000*"
    assert row_of(lines, "01")[3:5] == ["0.00000", "0.00000"]


def test_200_columns_hold_everything(made_up: Reproduction) -> None:
    assert row_of(lines_of(made_up, 200), "21") == [
        "21", "NN", "50-3", "still", "camera", "pictures,", "plane", "130", "1e-8", "-0.01240", "-0.01500",
        "-1.2%", "-4%", "4960", "1359", "55.8", "62.0", "124", "217", "7.4", "other", "epochs",
    ]  # fmt: skip


def test_footnotes_explain_marks_and_restrictions(made_up: Reproduction) -> None:
    text = " ".join(" ".join(lines_of(made_up, 200)).split())
    assert "16 rays a pixel; training stops after 300 epochs" in text
    assert "* The goal of the training was not reached" in text
    for exp, word in (("07", "prints -0.33330"), ("19", "opposite signs"), ("20", "14 m")):
        assert word in text[text.index("contradicts itself:") :]
        assert f"{exp} " in text[text.index("contradicts itself:") :]
    assert "medians of 5 runs" in text


def test_a_full_run_without_contradictions_needs_no_such_notes(made_up: Reproduction) -> None:
    plain = made_up.model_copy(update={"rows": made_up.rows[:2], "quick": False, "restrictions": ()})
    text = " ".join(lines_of(plain, 120))
    assert "Quick" not in text
    assert "!" not in text
    assert "*" not in text
