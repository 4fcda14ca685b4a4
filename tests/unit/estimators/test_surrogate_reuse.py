"""What the hybrid method of a surrogate has found is not found again, and is the same."""

import numpy as np
import pytest

from labcal.bench.distortion.case import Case, Cell, Layout
from labcal.bench.distortion.cell_data import cell_data
from labcal.bench.families.cameras import SIZE
from labcal.estimators.bundle import Bundle
from labcal.estimators.surrogate_validation import fit_unless_surrogate, surrogate_of

SIZES = (SIZE, SIZE)


@pytest.mark.slow
def test_bundle_takes_the_cameras_of_hybrid_with_the_same_bytes(monkeypatch: pytest.MonkeyPatch) -> None:
    data = cell_data(Case(Cell("brown", 0.6, 0.05, 40, Layout.PLANES), 0, (), (), 0))
    surrogate = surrogate_of(data.X, data.Y, SIZES)
    assert surrogate is not None
    fitted = Bundle(image_sizes=SIZES).fit(data.X, data.Y)
    with monkeypatch.context() as patched:
        patched.setattr(Bundle, "fit", lambda *_: pytest.fail("it is fitted again"))
        taken = fit_unless_surrogate(surrogate, Bundle(image_sizes=SIZES), data.X, data.Y)
    for array in fitted.stored_arrays():
        np.testing.assert_array_equal(getattr(taken, array.attribute), getattr(fitted, array.attribute))
    assert vars(taken).keys() == vars(fitted).keys()
    assert all(getattr(taken, fact) == getattr(fitted, fact) for fact in fitted.fitted_facts)
    other = fit_unless_surrogate(surrogate, Bundle("pinhole", SIZES), data.X, data.Y)
    assert isinstance(other, Bundle)
    assert {camera.lens for camera in other.cameras_} == {"pinhole"}
