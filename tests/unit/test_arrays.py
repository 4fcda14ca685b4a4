import jaxtyping
import numpy as np
import pytest

from labcal.arrays import float_array
from labcal.errors import InputError
from labcal.targets.grid import DotGrid


def test_a_wrong_shape_is_refused(grid: DotGrid) -> None:
    # Three columns where an index has two; only the annotation stands in the way.
    with pytest.raises(jaxtyping.TypeCheckError):
        grid.points(np.zeros((5, 3), dtype=np.int64))


def test_a_wrong_element_type_is_refused(grid: DotGrid) -> None:
    # NumPy would multiply floats as readily.
    with pytest.raises(jaxtyping.TypeCheckError):
        grid.points(np.zeros((5, 2)))


def test_masked_complex_numbers_are_refused_and_not_cut_to_their_real_part() -> None:
    with pytest.raises(InputError, match="q must hold real numbers throughout, but some elements are masked"):
        float_array(np.ma.masked_array([1j, 2j], mask=[True, False]), ("n",), "q")
    found = float_array(np.ma.masked_array([1, 2], mask=[True, False]), ("n",), "q")
    np.testing.assert_array_equal(found, [np.nan, 2.0])
