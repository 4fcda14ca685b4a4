import numpy as np
import pytest

from labcal.cameras.brown import Brown, distort, distort_jacobian, fold_radius_squared
from labcal.cameras.lens import LENSES, lens_by_name
from labcal.cameras.mathematics import NUMPY
from labcal.errors import UnknownNameError

DIST = np.array([-0.28, 0.11, 0.002, -0.003, -0.02])


def test_the_distortion_jacobian_is_the_slope() -> None:
    x, y = np.random.default_rng(1).uniform(-0.6, 0.6, (2, 200))
    h, numbers = 1e-6, tuple(DIST)
    along_x = (np.array(distort(numbers, x + h, y)) - np.array(distort(numbers, x - h, y))) / (2 * h)
    along_y = (np.array(distort(numbers, x, y + h)) - np.array(distort(numbers, x, y - h))) / (2 * h)
    a, b, d = distort_jacobian(numbers, x, y)
    np.testing.assert_allclose([a, b], along_x, atol=1e-9)
    np.testing.assert_allclose([b, d], along_y, atol=1e-9)


@pytest.mark.parametrize(
    ("dist", "expected"),
    [
        ((0.0, 0, 0, 0, 0), np.inf),
        ((0.2, 0, 0, 0, 0), np.inf),
        ((-0.3, 0, 0, 0, 0), 1 / 0.9),
        ((-0.3, 0.09, 0, 0, 0), np.inf),  # 1 - 0.9 s + 0.45 s^2 has no real root
        ((0.0, -0.2, 0, 0, 0), 1.0),
        ((0.0, 0, 0, 0, -1 / 7), 1.0),
    ],
)
def test_the_fold_is_where_the_radius_stops_growing(dist: tuple[float, ...], expected: float) -> None:
    assert fold_radius_squared(np.array(dist)) == pytest.approx(expected)


def test_the_fold_agrees_with_a_scan() -> None:
    rng = np.random.default_rng(2)
    r = np.linspace(0, 6, 60001)
    for _ in range(50):
        dist = rng.normal(size=5) * [0.3, 0.1, 0, 0, 0.03]
        k1, k2, _, _, k3 = dist
        falls = np.flatnonzero(np.diff(r * (1 + k1 * r**2 + k2 * r**4 + k3 * r**6)) < 0)
        fold = np.sqrt(fold_radius_squared(dist))
        if len(falls):
            assert fold == pytest.approx(r[falls[0]], abs=3e-4)
        else:
            assert fold > 5.9


def test_a_pinhole_ignores_no_direction_in_front() -> None:
    lens = Brown("pinhole", 0)
    x, y, ok = lens.image(
        NUMPY, lens.numbers(np.zeros(5)), np.array([99.0]), np.array([-3.0]), np.array([1.0])
    )
    np.testing.assert_array_equal([x[0], y[0], ok[0]], [99.0, -3.0, True])


def test_every_lens_is_found_by_its_name() -> None:
    assert all(lens_by_name(name).name == name for name in LENSES)
    with pytest.raises(UnknownNameError, match="'brown-k1k2'"):
        lens_by_name("brown-k1-k2")
