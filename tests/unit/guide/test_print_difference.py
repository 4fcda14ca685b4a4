"""Checks by new pictures of another print: what is said, and that the same print is not named."""

import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

sys.path.insert(0, str(Path(__file__).parent))

from simulated_pair import KIND, NOISE_PX, TARGET, one, rig, seen

from labcal import Detections
from labcal.bench.solve.pair_dots import pair_dots
from labcal.guide.checking import checked
from labcal.guide.rig_check import CheckVerdict
from labcal.report.check_result import check_result, check_words
from labcal.rng import generator


def of_print(dots: np.ndarray, seed: int = 0) -> Detections:
    """Return dots of new views of a print, by the cameras as they were."""
    random = generator(seed, "another print")
    return pair_dots(KIND.cameras(), TARGET, dots, KIND.poses(4, random), (NOISE_PX, random))


def test_a_scaled_print_is_named_beside_the_shift_that_looks_the_same() -> None:
    found = checked(rig(), of_print(1.001 * TARGET.points()), TARGET)
    assert found.verdict is CheckVerdict.CHANGED
    other = found.print_difference
    assert other is not None
    assert other.scale_ppm is not None
    assert other.scale_sigma_ppm is not None
    assert abs(other.scale_ppm - 1000.0) < 3.0 * other.scale_sigma_ppm
    assert "ppm" in check_words(found).splitlines()[0]
    assert any("Measure the print" in words for words in found.warnings)
    assert check_result(found).print_difference == other


def test_a_dot_that_is_off_is_named_and_does_not_change_the_verdict() -> None:
    dots = TARGET.points()
    dots[5, 0] += 20.0 * KIND.print_mm
    found = checked(rig(), of_print(dots), TARGET)
    assert found.verdict is not CheckVerdict.CHANGED
    assert found.print_difference is not None
    (named,) = found.print_difference.dots
    assert (named.col, named.row) == (5, 0)
    assert named.off_mm == pytest.approx(20.0 * KIND.print_mm, rel=0.2)
    assert any("(5, 0) by" in words for words in found.warnings)


def test_an_uneven_print_is_measured() -> None:
    off = generator(3, "off").normal(0.0, 3.0 * KIND.print_mm, (TARGET.count, 2))
    found = checked(rig(), of_print(TARGET.points() + np.pad(off, ((0, 0), (0, 1)))), TARGET)
    assert found.verdict is not CheckVerdict.CHANGED
    assert found.print_difference is not None
    rms = float(np.sqrt((off**2).sum(axis=1).mean()))
    assert found.print_difference.uneven_mm == pytest.approx(rms, rel=0.2)
    assert found.print_difference.scale_ppm is None


@pytest.mark.parametrize("seed", [0, *(pytest.param(n, marks=pytest.mark.slow) for n in (1, 2, 3))])
def test_the_same_print_is_not_named(seed: int) -> None:
    assert checked(rig(), seen(None, [], seed=seed), TARGET).print_difference is None
    turned = checked(rig(), seen(one("turned", 1), [0.0, 2e-3, 0.0], seed=seed), TARGET)
    assert turned.verdict is CheckVerdict.CHANGED
    assert turned.print_difference is None


def test_a_wrong_dot_in_one_picture_is_no_matter_of_the_print() -> None:
    dots = seen(None, [])
    wrong = (
        (dots.view == dots.views[0]) & (dots.camera == dots.cameras[0]) & (dots.index == [3, 3]).all(axis=1)
    )
    assert wrong.sum() == 1
    moved = replace(dots, position=np.where(wrong[:, None], dots.position + 3.0, dots.position))
    found = checked(rig(), moved, TARGET)
    assert found.print_difference is None or not found.print_difference.dots
