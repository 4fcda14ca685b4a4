import jaxtyping
import numpy as np
import pytest

from labcal.targets.grid import DotGrid


def test_a_wrong_shape_is_refused(grid: DotGrid) -> None:
    # Three columns where an index has two; only the annotation stands in the way.
    with pytest.raises(jaxtyping.TypeCheckError):
        grid.points(np.zeros((5, 3), dtype=np.int64))


def test_a_wrong_element_type_is_refused(grid: DotGrid) -> None:
    # NumPy would multiply floats as readily.
    with pytest.raises(jaxtyping.TypeCheckError):
        grid.points(np.zeros((5, 2)))
