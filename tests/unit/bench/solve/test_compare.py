"""The benchmark of comparisons: one case."""

from labcal.bench.solve.compare import CompareCase, compared_case
from labcal.evaluate.comparison.rig_comparison import LEAST_CHANCE


def test_a_turned_camera_is_found_between_calibrations_that_agree() -> None:
    found = compared_case(CompareCase("webcam", 0))
    assert found.p_value > LEAST_CHANCE > found.changed_p_value[1]
    assert 0.3 < found.power[0] < found.power[1] <= 1.0
    assert 0.1 < found.square < 4.0
