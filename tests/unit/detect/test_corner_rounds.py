"""Fits of all corners of a board in one call, the tables that they take, and their errors."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.special import erf

from labcal.bench.boards.board_view import axes_at
from labcal.bench.boards.chessboard_picture import PLAIN, _ink
from labcal.bench.marks.drawn_picture import Exposure, drawn, tilted
from labcal.detect.corners.corner_chunks import CHUNK
from labcal.detect.corners.corner_fit import SettledCorner, fit_corners, judge, judge_all
from labcal.detect.corners.corner_kernel import (
    CHESSBOARD,
    LIGHT_KNOWN,
    PARAMETERS,
    WEDGE,
    FitLimits,
    pattern_values,
    settled_with,
    take_known_light,
)
from labcal.detect.corners.corner_pixels import PackedCorner
from labcal.detect.corners.corner_rows import ROWS
from labcal.detect.corners.corner_window import Places
from labcal.detect.corners.edge_profile import edge_profile
from labcal.detect.corners.saddle_strength import saddle_strength, strongest_places
from labcal.detect.edges.outline_noise import smooth_wave_ratio
from labcal.detect.settings import DEFAULTS


@pytest.fixture(scope="module")
def fits() -> list[SettledCorner]:
    """Fits of nine corners of a board, made in one call."""
    H = tilted(0.4, 0.8, 0.3, 600.0 / 18.0, 600.0) @ np.array([[1.0, 0, -4], [0, 1, -2.5], [0, 0, 1]])
    H = np.array([[1.0, 0.0, 240.0], [0.0, 1.0, 180.0], [0.0, 0.0, 1.0]]) @ H
    how = Exposure((480, 360), H, 1.0, np.zeros(2), 0.01)
    grey = drawn(how, _ink(PLAIN), (), np.random.default_rng(0)).astype(np.float32)
    index = np.array([(i, j) for i in (2, 4, 6) for j in (1, 2, 3)])
    centre = how.seen(index.astype(np.float64)) + 0.3
    axes = np.array([axes_at(how, place.astype(np.float64)) for place in index])
    white = np.where(PLAIN.is_black(index[:, 0] + 1, index[:, 1] + 1), -1.0, 1.0)
    limits = np.stack([white, *np.tile([[1.0], [1.0], [6.2], [0.45], [np.inf]], 9)], axis=1)
    places = Places(centre, axes, np.zeros((9, 2)), limits)
    together = fit_corners(grey, places, DEFAULTS.corner)
    for k, fit in enumerate(together):
        (alone,) = fit_corners(grey, Places(*(part[k : k + 1] for part in places)), DEFAULTS.corner)
        assert fit is not None
        assert alone is not None
        np.testing.assert_array_equal(fit.state, alone.state)
        np.testing.assert_array_equal(fit.window.value, alone.window.value)
    return [fit for fit in together if fit is not None]


def test_the_profile_of_an_edge_is_right_to_a_millionth_of_a_millionth() -> None:
    places = np.random.default_rng(0).uniform(-9.0, 9.0, 3000)
    profile, slope = np.array([edge_profile(place) for place in places.tolist()]).T
    np.testing.assert_allclose(profile, erf(places / np.sqrt(2.0)), rtol=0.0, atol=1e-12)
    expected = np.sqrt(2.0 / np.pi) * np.exp(-0.5 * places**2)
    np.testing.assert_allclose(slope, expected, rtol=0.0, atol=1e-12)


@pytest.mark.parametrize("pattern", [CHESSBOARD, WEDGE])
@pytest.mark.parametrize("correlation", [0.0, -0.3, 0.9])
def test_a_pixel_of_many_chunks_shows_what_it_shows_alone(pattern: int, correlation: float) -> None:
    u = np.random.default_rng(1).uniform(-9.0, 9.0, (2, 2 * CHUNK + 5))
    together = pattern_values(u, correlation, np.array([4.0, 5.0]), pattern)
    for k in range(0, u.shape[1], 7):
        alone = pattern_values(u[:, k : k + 1].copy(), correlation, np.array([4.0, 5.0]), pattern)
        assert together[k] == alone[0]


def test_far_from_the_other_edge_the_pattern_is_the_profile_of_one() -> None:
    u = np.array([np.linspace(-7.9, 7.9, 300), np.full(300, 7.5)])
    expected = erf(u[0] / np.sqrt(2.0))
    found = pattern_values(u, 0.2, np.full(2, 99.0), CHESSBOARD)
    np.testing.assert_allclose(found, expected, rtol=0.0, atol=1e-9)


def test_pixels_that_are_taken_out_later_give_the_same_uncertainty(fits: list[SettledCorner]) -> None:
    assert all(isinstance(fit.pixels, PackedCorner) for fit in fits)
    unpacked = [replace(fit, pixels=fit.window) for fit in fits]
    both = judge_all([*unpacked[:5], *fits[5:]], DEFAULTS.corner)
    for one, other in zip(judge_all(fits, DEFAULTS.corner), both, strict=True):
        assert one is not None
        assert other is not None
        np.testing.assert_array_equal(one.covariance, other.covariance)
        np.testing.assert_array_equal(one.sums, other.sums)


def test_fits_are_judged_together_as_each_alone(fits: list[SettledCorner]) -> None:
    for fit, one in zip(fits, judge_all([*fits[:4], None, *fits[4:]], DEFAULTS.corner)[:4], strict=False):
        alone = judge(fit, DEFAULTS.corner)
        assert one is not None
        assert alone is not None
        np.testing.assert_array_equal(one.covariance, alone.covariance)
        np.testing.assert_array_equal(one.powers, alone.powers)
        np.testing.assert_array_equal(one.sums, alone.sums)


def test_judgements_of_corners_that_are_none_are_none(fits: list[SettledCorner]) -> None:
    found = judge_all([None, fits[0], None], DEFAULTS.corner)
    assert [one is None for one in found] == [True, False, True]
    assert judge_all([None], DEFAULTS.corner) == [None]


def test_a_fit_with_another_light_begins_where_the_linear_model_has_its_least_squares(
    fits: list[SettledCorner],
) -> None:
    limits = DEFAULTS.corner.limits(FitLimits)
    for fit in fits:
        state, normal = fit.state.copy(), np.empty((ROWS, ROWS))
        assert settled_with(state, fit.window.arrays, (1e-6, PARAMETERS), limits, normal) > 0.0
        slope = state[LIGHT_KNOWN:] + np.array([2e-4, -1e-4])
        guess, plain = state.copy(), state.copy()
        take_known_light(guess, normal, slope)
        for one in (guess, plain):
            one[LIGHT_KNOWN:] = slope
        end = plain.copy()
        assert settled_with(end, fit.window.arrays, (1e-6, LIGHT_KNOWN), limits, normal) > 0.0
        moved, left = np.linalg.norm(plain[:2] - end[:2]), np.linalg.norm(guess[:2] - end[:2])
        assert left < 0.05 * moved


def test_waves_of_one_corner_that_go_together_widen_the_error() -> None:
    random = np.random.default_rng(3)
    wavelengths = 2.0 * 6.0 / np.arange(1, 7)
    scores = []
    for _ in range(300):
        shared = random.exponential(size=(60, 3))
        seen = np.repeat(shared, 2, axis=1)  # pairs of waves are the same
        powers = np.stack([seen, np.ones_like(seen)], axis=-1)
        ratio, error = smooth_wave_ratio(powers, wavelengths, DEFAULTS.edge)
        scores.append(np.log(ratio) / error)
    # 300 standard normal scores: their variance is 1 within four of its deviations. Without it, it is 2.
    assert abs(np.var(scores) - 1.0) < 4.0 * np.sqrt(2.0 / 300.0)


def test_saddle_points_are_the_strongest_pixels_around() -> None:
    y, x = np.mgrid[:40, :50].astype(np.float32)
    smooth = (np.tanh((x - 20.2) / 2.0) * np.tanh((y - 14.7) / 2.0)).astype(np.float32)
    strength = saddle_strength(smooth)
    assert not strength[[0, -1]].any()
    rows, columns = strongest_places(strength, 0.5 * float(strength.max()))
    assert (rows.tolist(), columns.tolist()) == ([15], [20])
