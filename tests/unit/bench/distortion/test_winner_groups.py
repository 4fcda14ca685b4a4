"""Winners of a family and strength together."""

import math

import pytest

from labcal.bench.distortion.page.winner_table import winner_cells
from labcal.bench.distortion.winner_groups import winner_groups
from labcal.bench.distortion.winners import Winner


def winner(best: str | None, lead: float, won: int = 3, **changes: object) -> Winner:
    one = Winner(
        family="water", strength=0.5, noise_px=0.1, points=140, layout="planes", measured="within",
        best=best, over_oracle=math.nan if best is None else 1.1, second="dlt", second_over_best=lead,
        seeds_won=won, seeds=3,
    )  # fmt: skip
    return one.model_copy(update=changes)


def test_cells_are_counted_by_their_best_method_and_clear_ones_apart() -> None:
    winners = [
        winner("bundle", 1.06),
        winner("hybrid", 1.2),
        winner("hybrid", 3.0, won=2),  # a seed disagrees
        winner("hybrid", 1.04),  # too close
        winner("dlt", 9.0, measured="outside"),
        winner("dlt", 9.0, strength=1.0),
    ]
    half, full = winner_groups(winners, "within")
    assert (half.family, half.strength, half.cells, half.clear) == ("water", 0.5, 4, 2)
    assert half.won == {"hybrid": 3, "bundle": 1}
    assert half.lead == pytest.approx((1.13, 1.04, 3.0))
    assert full.won == {"dlt": 1}
    assert winner_cells(half) == [
        "water 0.5", "index 1.167, tilt 15 deg", "hybrid 3, bundle 1", "1.10", "1.13 (1.04 to 3.00)",
        "2 of 4",
    ]  # fmt: skip


def test_cells_without_a_figure_have_no_winner() -> None:
    (group,) = winner_groups([winner(None, math.nan, won=0)], "within")
    assert (group.cells, group.won, group.clear) == (0, {}, 0)
    assert winner_cells(group)[2:] == ["–", "–", "–", "0 of 0"]  # noqa: RUF001 -- meant
