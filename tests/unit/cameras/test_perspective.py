import numpy as np
import pytest

from labcal.cameras.lens import LENSES, lens_by_name
from labcal.cameras.mathematics import NUMPY, NumpyMathematics
from labcal.cameras.perspective import Perspective, fold_radius_squared
from labcal.errors import UnknownNameError


def padded(*dist: float) -> tuple[float, ...]:
    return (*map(float, dist), *(0.0,) * (14 - len(dist)))


@pytest.mark.parametrize(
    ("dist", "expected"),
    [
        ((0.0, 0, 0, 0, 0), np.inf),
        ((0.2, 0, 0, 0, 0), np.inf),
        ((-0.3, 0, 0, 0, 0), 1 / 0.9),
        ((-0.3, 0.09, 0, 0, 0), np.inf),  # 1 - 0.9 s + 0.45 s^2 has no real root
        ((0.0, -0.2, 0, 0, 0), 1.0),
        ((0.0, 0, 0, 0, -1 / 7), 1.0),
        ((0.0, 0, 0, 0, 0, -0.25), 4.0),  # the denominator vanishes
        ((0.0, 0, 0, 0, 0, 0.25), 4.0),  # r / (1 + r^2 / 4) has its top at 2
    ],
)
def test_the_fold_is_where_the_radius_stops_growing(dist: tuple[float, ...], expected: float) -> None:
    assert fold_radius_squared(padded(*dist)) == pytest.approx(expected)


def test_the_fold_agrees_with_a_scan() -> None:
    rng = np.random.default_rng(2)
    r = np.linspace(0, 6, 60001)
    for _ in range(50):
        dist = (rng.normal(size=8) * [0.3, 0.1, 0, 0, 0.03, 0.2, 0.05, 0.01]).tolist()
        k1, k2, _, _, k3, k4, k5, k6 = dist
        bottom = 1 + k4 * r**2 + k5 * r**4 + k6 * r**6
        falls = np.diff(r * (1 + k1 * r**2 + k2 * r**4 + k3 * r**6) / bottom) < 0
        ends = np.flatnonzero(falls | (bottom[1:] <= 0))
        fold = np.sqrt(fold_radius_squared(padded(*dist)))
        if len(ends):
            assert fold == pytest.approx(r[ends[0]], abs=3e-4)
        else:
            assert fold > 5.9


def test_a_pinhole_ignores_no_direction_in_front() -> None:
    lens = Perspective("pinhole", 0)
    found = lens.field_point(
        NUMPY, lens.parameters(NUMPY, padded(), 1.0), (np.array([99.0]), np.array([-3.0]), 1.0)
    )
    np.testing.assert_array_equal([found.a[0], found.b[0], found.ok[0]], [99.0, -3.0, True])


def test_a_weak_lens_is_inverted_in_a_single_step() -> None:
    lens = lens_by_name("brown5")
    parameters = lens.parameters(NUMPY, padded(-0.3, 0.09, 6e-4, -4e-4, 0.0), 0.6)
    x, y = np.random.default_rng(3).uniform(-0.4, 0.4, (2, 1000))
    quick = lens.undistort(NumpyMathematics(1, settled=1e-4), parameters, x, y)
    assert np.all(quick.ok)
    back = lens.distort(NUMPY, parameters, quick.a, quick.b)
    np.testing.assert_allclose(back, [x, y], rtol=0, atol=1e-10)


def test_an_inverse_that_has_not_settled_says_so() -> None:
    lens = lens_by_name("rational8")
    parameters = lens.parameters(NUMPY, padded(0.9, -0.4, 6e-4, -4e-4, 0.05, 1.25, -0.2, 0.03), 0.1)
    found = lens.undistort(NumpyMathematics(1, settled=1e-8), parameters, np.array([0.9]), np.array([0.6]))
    assert not found.ok.any()  # far beyond the reach of the first guess


def test_every_lens_is_found_by_its_name() -> None:
    assert all(lens_by_name(name).name == name for name in LENSES)
    with pytest.raises(UnknownNameError, match="'brown-k1k2'"):
        lens_by_name("brown-k1-k2")
