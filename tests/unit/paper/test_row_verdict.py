"""The verdict on a row, rule by rule."""

import pytest

from labcal.paper.row_verdict import row_verdict
from labcal.paper.rows import ROWS, row_named
from labcal.paper.summary import figures_of
from labcal.paper.training_run import TrainingOutcome
from labcal.report.row_verdict import RowVerdict


def _runs(signed_mm: tuple[float, ...], epochs: tuple[int | None, ...]) -> list[TrainingOutcome]:
    return [
        TrainingOutcome(
            mean_signed_mm=signed, mean_coordinate_mm=800.0, mae_mm=1.0, rmse_mm=2.0, p95_mm=3.0, max_mm=4.0,
            further_rmse=(), epochs=count, goal_reached=None if count is None else True, seconds=1.0,
        )
        for signed, count in zip(signed_mm, epochs, strict=True)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("exp", "signed_mm", "epochs", "verdict"),
    [
        # Row 08: +0.10 mm in 9 epochs, printed to 0.01 mm.
        ("08", (0.05, 0.2), (9, 9), RowVerdict.MATCHES),
        ("08", (0.104, 0.2), (9, 9), RowVerdict.MATCHES),
        ("08", (0.106, 0.2), (9, 9), RowVerdict.LARGER),
        ("08", (-0.3, 0.096), (9, 9), RowVerdict.MATCHES),
        ("08", (-0.05, 0.05), (9, 9), RowVerdict.SMALLER),
        ("08", (-0.3, -0.2), (9, 9), RowVerdict.LARGER),
        ("08", (0.05, 0.2), (18, 18), RowVerdict.MATCHES),
        ("08", (0.05, 0.2), (19, 19), RowVerdict.OTHER_EPOCHS),
        ("08", (0.05, 0.2), (4, 4), RowVerdict.OTHER_EPOCHS),
        ("08", (0.05, 0.2), (8, 100), RowVerdict.MATCHES),
        ("08", (-0.05, 0.05), (100, 100), RowVerdict.SMALLER),
        # Row 05: least squares, -6.78 mm. Three hundred times less is no match.
        ("05", (-0.02, 0.01), (None, None), RowVerdict.SMALLER),
        ("05", (-7.0, -6.0), (None, None), RowVerdict.MATCHES),
        # Row 01 prints zero.
        ("01", (0.004, 0.004), (7, 7), RowVerdict.MATCHES),
        ("01", (0.006, 0.007), (7, 7), RowVerdict.LARGER),
        ("07", (-333.3, -333.3), (7, 7), RowVerdict.CONTRADICTION),
    ],
)
def test_rules(
    exp: str, signed_mm: tuple[float, ...], epochs: tuple[int | None, ...], verdict: RowVerdict
) -> None:
    assert row_verdict(row_named(exp), figures_of("x", _runs(signed_mm, epochs))) is verdict


def test_every_row_gets_one_of_five() -> None:
    figures = figures_of("x", _runs((0.01,), (10,)))
    assert {row_verdict(row, figures) for row in ROWS} <= set(RowVerdict)
    assert all(verdict.meaning and len(verdict.short) <= len(verdict) for verdict in RowVerdict)
