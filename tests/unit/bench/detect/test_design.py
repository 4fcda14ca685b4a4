import numpy as np
import pytest

from labcal.bench.detect.design import GRADIENT, TILT_DEG, designs


def test_every_stratum_of_a_quantity_is_drawn_from_once() -> None:
    suite = list(designs(40, 0))
    for values, ends in (
        ([one.tilt_deg for one in suite], TILT_DEG),
        ([np.log(one.gradient) for one in suite], np.log(GRADIENT)),
    ):
        share = (np.array(values) - ends[0]) / (ends[1] - ends[0])
        assert sorted((40 * share).astype(int)) == list(range(40))


def test_quantities_are_drawn_independently() -> None:
    suite = list(designs(320, 0))
    tilt, noise = np.array([(one.tilt_deg, np.log(one.noise)) for one in suite]).T
    # The correlation of 320 independent pairs has a standard deviation of 0.056.
    assert abs(np.corrcoef(tilt, noise)[0, 1]) < 3.3 * 0.056
    assert {one.lens for one in suite} == {"pinhole", "brown-k1k2", "fisheye-kb4"}


def test_dots_of_the_middle_are_never_flatter_than_can_be_measured() -> None:
    minor = [one.radius_px * np.sqrt(np.cos(np.radians(one.tilt_deg))) for one in designs(320, 1)]
    assert min(minor) > 3.99


def test_designs_follow_from_the_seed() -> None:
    assert list(designs(10, 3)) == list(designs(10, 3))
    assert list(designs(10, 3)) != list(designs(10, 4))


@pytest.mark.parametrize("count", [48, 320])
def test_names_are_unique(count: int) -> None:
    assert len({one.name for one in designs(count, 0)}) == count
