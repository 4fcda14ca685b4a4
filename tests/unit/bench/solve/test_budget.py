"""One cell of the benchmark of the error budget."""

import pytest

from labcal.bench.solve.budget_rigs import KINDS
from labcal.bench.solve.budget_set import BudgetSet, measured_set
from labcal.bench.solve.named_points_growth import named_points_checks


@pytest.mark.parametrize("kind", KINDS)
def test_both_cameras_look_at_the_middle_of_the_volume(kind: str) -> None:
    pair = KINDS[kind]
    for camera in pair.cameras():
        q = camera.project([0.0, 0.0, pair.distance_mm]).q
        assert abs(q - [pair.size[0] / 2, pair.size[1] / 2]).max() < 0.06 * pair.size[0]


def test_a_set_is_covered_by_its_budget_and_not_by_noise_alone() -> None:
    found = measured_set(BudgetSet("webcam", "uneven", 6, "brown5", 1))
    assert found.points > 0.8
    assert found.noise_alone < 0.2
    assert 0.4 < found.parameters < 2.0
    assert not found.warned


def test_a_lens_that_is_too_simple_is_warned_of() -> None:
    assert measured_set(BudgetSet("webcam", "even", 12, "brown-k1k2", 0)).warned


@pytest.mark.slow
def test_time_and_memory_of_named_points_are_measured() -> None:
    checks = named_points_checks(1, 800)
    assert [check.limit for check in checks] == [30.0, 2.0, 1.3]
    assert all(check.value > 0.0 for check in checks[:2])
