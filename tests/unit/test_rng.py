import subprocess
import sys

import numpy as np

from labcal.rng import generator, integer_seed


def test_the_same_names_give_the_same_numbers() -> None:
    first = generator(3, "v01", "left", "noise").normal(size=100)
    assert np.array_equal(first, generator(3, "v01", "left", "noise").normal(size=100))


def test_the_numbers_do_not_depend_on_the_process() -> None:
    # hash() of a text is salted in every process; a stream must not be.
    code = "from labcal.rng import integer_seed; print(integer_seed(3, 'v01', 'left'))"
    command = [sys.executable, "-c", code]
    printed = {subprocess.run(command, capture_output=True, text=True, check=True).stdout for _ in range(2)}
    assert printed == {f"{integer_seed(3, 'v01', 'left')}\n"}


def test_other_seeds_and_other_names_give_independent_numbers() -> None:
    names = [(seed, view, camera) for seed in (0, 1) for view in ("a", "b") for camera in ("left", "right")]
    streams = np.stack([generator(seed, view, camera).normal(size=4000) for seed, view, camera in names])
    correlation = np.corrcoef(streams)[np.triu_indices(len(names), k=1)]
    # Correlations of 28 independent pairs have the standard deviation 1 / sqrt(4000): 4 sigma.
    assert np.abs(correlation).max() < 4 / np.sqrt(4000)


def test_the_border_between_names_counts() -> None:
    assert integer_seed(0, "ab", "c") != integer_seed(0, "a", "bc")
