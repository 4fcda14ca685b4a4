import numpy as np
import pytest
from scipy.ndimage import uniform_filter1d
from scipy.stats import norm

from labcal.bench.detect.bound import ImagedDot, _coverage, centre_bound, centre_bounds, outline_shapes


def imaged(shape: np.ndarray, centre: tuple[float, float] = (60.3, 50.8)) -> ImagedDot:
    return ImagedDot(np.array(centre), shape, 0.7, 0.1, 0.8, 1.5)


def test_a_wide_dot_has_the_profile_of_a_blurred_step_seen_by_pixels() -> None:
    radius, blur, x = 30.0, 0.8, 40.37
    covered = _coverage(np.array([x, 40.0, radius**2, 0.0, radius**2, blur]), (81, 81))
    # Along the row through the middle the outline is a step, but for its curvature: 1/60 px per px squared.
    fine = np.arange(-10.0, 10.0, 0.01)
    step = uniform_filter1d(norm.cdf(-fine / blur), 100)
    pixels = np.arange(66, 76)
    expected = np.interp(pixels - (x + radius), fine, step)
    np.testing.assert_allclose(covered[40, 66:76], expected, atol=0.008)


@pytest.mark.parametrize("radius", [10.0, 20.0, 40.0])
def test_the_bound_of_a_circle_is_that_of_its_outline(radius: float) -> None:
    bound = centre_bound(imaged(radius**2 * np.eye(2)), 0.01)
    # Each piece of the outline tells of its own shift: the integral of a Gauss function's square, times the
    # contrast's. The slope of the light, unknown too, costs a little more, and less for a larger dot.
    sigma = np.sqrt(0.7**2 + 1.0 / 12.0)
    information = np.pi * radius * 0.7**2 / (2.0 * sigma * np.sqrt(np.pi)) / 0.01**2
    ratio = np.sqrt(np.diag(bound) * information)
    assert (ratio > 0.99).all()
    assert (ratio < 1.12).all()
    assert abs(bound[0, 1]) < 0.02 * bound[0, 0]


def test_the_bound_turns_with_the_dot_and_grows_with_the_noise() -> None:
    turn = np.array([[0.6, -0.8], [0.8, 0.6]])
    flat = np.diag([20.0**2, 10.0**2])
    level = centre_bound(imaged(flat), 0.02)
    turned = centre_bound(imaged(turn @ flat @ turn.T), 0.02)
    np.testing.assert_allclose(turned, turn @ level @ turn.T, atol=0.03 * level.max())
    np.testing.assert_allclose(centre_bound(imaged(flat), 0.01), level / 4.0)
    assert level[0, 0] > level[1, 1]  # along its long axis a dot is known less well


def test_darker_pixels_with_less_noise_tell_more_of_the_centre() -> None:
    radius, dark, light = 30.0, 0.004, 0.016
    dot, mean = imaged(radius**2 * np.eye(2)), np.sqrt(0.5 * (dark**2 + light**2))
    own, alike = centre_bounds(dot, np.array([[dark, light], [mean, mean]]))
    np.testing.assert_allclose(alike, centre_bound(dot, float(mean)))
    # Each piece of the outline tells of its own shift, as above, but each pixel by its own variance.
    x, sigma = np.linspace(-6.0, 6.0, 4001), np.sqrt(0.7**2 + 1.0 / 12.0)
    share = norm.cdf(-x / sigma)
    told = (0.7 * norm.pdf(x / sigma) / sigma) ** 2 / (share * dark**2 + (1.0 - share) * light**2)
    ratio = np.sqrt(np.diag(own) * np.pi * radius * np.trapezoid(told, x))
    assert (ratio > 0.99).all()
    assert (ratio < 1.12).all()
    assert np.trace(own) < 0.9 * np.trace(alike)


def test_the_shape_of_an_outline_is_that_of_its_ellipse() -> None:
    angle = 2.0 * np.pi * np.arange(64) / 64
    A = np.array([[9.0, 2.0], [1.0, 5.0]])
    outline = np.stack([np.cos(angle), np.sin(angle)], axis=-1) @ A.T + [100.0, 50.0]
    np.testing.assert_allclose(outline_shapes(outline[None])[0], A @ A.T)
