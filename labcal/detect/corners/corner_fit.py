"""Sub-pixel fit of one corner of a chessboard: two blurred edges that cross, with the light's slope."""

from dataclasses import dataclass

import numpy as np
from scipy.special import erf, ndtr, owens_t

from labcal.detect.edges.residuals import LAGS, REACH, SUMS
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings

_PARAMETERS = 10
_MOST_OBLIQUE = 0.999  # cosine of the angle between the edges
_TINY = 1e-9


@dataclass(frozen=True)
class Surroundings:
    """Surroundings of a corner: where it is, its squares and the nearest markers.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the corner is, px, to about a pixel.
    axes : ndarray, shape (2, 2)
        Columns: one square along the board's x and y, px.
    white : int
        1 where the upper right square of the board (and the lower left one) is white, -1 where it is black.
    gap : float
        White between a corner and the nearest marker, along x and along y, in squares.
    reach : float
        How far the edges are straight enough, px.
    """

    centre: np.ndarray
    axes: np.ndarray
    white: int
    gap: float
    reach: float


@dataclass(frozen=True)
class CornerFit:
    """The fit of one corner.

    Attributes
    ----------
    centre : ndarray, shape (2,)
        Where the edges cross, px.
    covariance : ndarray, shape (2, 2)
        Of `centre`, px squared, for noise that is independent from pixel to pixel.
    step : float
        From black to white, in grey values.
    roughness : float
        Root mean square residual over the step from black to white.
    sums : ndarray, shape (LAGS, SUMS)
        Sums of the residuals over the noise, see :func:`labcal.detect.edges.noise.noise_factor`.
    """

    centre: np.ndarray
    covariance: np.ndarray
    step: float
    roughness: float
    sums: np.ndarray


@dataclass(frozen=True)
class _Window:
    """The pixels of a fit: their mask in their rectangle, offsets (2, n) from its start, and grey values."""

    mask: np.ndarray
    offset: np.ndarray
    value: np.ndarray
    gap: np.ndarray
    """(2,), from the corner's edges to those of the markers, px."""


@dataclass(frozen=True)
class _Linear:
    """Residuals and derivatives by corner 2, angles of normals 2, blurs 2, mean, half step, slope 2."""

    residual: np.ndarray
    jacobian: np.ndarray
    board: np.ndarray
    """The modelled pattern, from -1 (black) to 1 (white)."""
    off_edges: np.ndarray
    """The smaller distance of every pixel from the two edges, in blurs."""


@dataclass(frozen=True)
class _Board:
    """A blurred chessboard, and its derivatives by the two distances and by the correlation."""

    value: np.ndarray
    by_first: np.ndarray
    by_second: np.ndarray
    by_correlation: np.ndarray


def fit_corner(grey: GreyPicture, around: Surroundings, settings: CornerSettings) -> CornerFit | None:
    """Fit ``(1 + g d) (m + h X(u1 / s1, u2 / s2))`` to the pixels around a corner, by Gauss-Newton.

    `u1` and `u2` are the distances from the two edges, `s1` and `s2` their blurs, `d` the offset from where
    the fit begins, and ``X`` a chessboard of -1 and 1 blurred by a Gaussian: the expectation of
    ``sign(a + z1) sign(b + z2)`` for standard normal z1, z2 that are as correlated as the edges' normals.
    That is ``1 - 4 T(a, .) - 4 T(b, .)``, less 2 where a and b differ in sign, with Owen's T (Owen 1956,
    Annals of Mathematical Statistics 27). The darkness that a marker's border spreads is subtracted. Whatever
    else is not as modelled, but the same on opposite sides of the corner, does not move it.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    around : Surroundings
        Where to begin.
    settings : CornerSettings

    Returns
    -------
    CornerFit or None
        None where the fit does not converge near the beginning, or on squares of the wrong colours.
    """
    square = float(np.sqrt(abs(np.linalg.det(around.axes))))
    narrow = float(np.linalg.svd(around.axes, compute_uv=False)[-1])
    window = _window(grey, around, settings.marker_guard_blurs * settings.first_blur_px / narrow, settings)
    first = _settle(
        _begin(window, around, settings.first_blur_px), window, settings.first_tolerance_px, settings
    )
    if first is None:
        return None
    # What is left out around markers follows the blur, now that it is known.
    blur = float(first[4:6].max())
    window = _window(grey, around, settings.marker_guard_blurs * blur / narrow, settings)
    state = _settle(first, window, settings.tolerance_px, settings)
    if state is None or state[7] <= 0 or state[4:6].max() > settings.max_blur_squares * narrow:
        return None
    moved = float(np.hypot(state[0], state[1]))
    if moved > min(settings.max_move_squares * square, around.reach):
        return None
    if is_cut(around.centre + state[:2], grey, settings.frame_margin_px):
        return None
    return _judge(state, window, around, settings)


def is_cut(place: np.ndarray, grey: GreyPicture, margin: float) -> bool:
    """Tell whether the frame is nearer to a corner than a margin (px), or leaves nothing of it."""
    last = np.array(grey.shape[::-1]) - 1
    return bool((place < margin).any() or (place > last - margin).any())


def _window(grey: GreyPicture, around: Surroundings, guard: float, settings: CornerSettings) -> _Window:
    """Select the pixels around a corner that belong to its own edges; `guard` is in squares."""
    height, width = grey.shape
    low = np.maximum(np.ceil(around.centre - around.reach), 0).astype(int)
    high = np.minimum(np.floor(around.centre + around.reach), [width - 1, height - 1]).astype(int)
    if (high < low).any():
        return _Window(np.zeros((0, 0), dtype=bool), np.zeros((2, 0)), np.zeros(0), np.zeros(2))
    y, x = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    offset = np.stack([x.ravel() - around.centre[0], y.ravel() - around.centre[1]])
    along, up = np.linalg.solve(around.axes, offset)
    nearest, farthest = np.minimum(np.abs(along), np.abs(up)), np.maximum(np.abs(along), np.abs(up))
    marked = (along * up * around.white > 0) & (nearest > around.gap - guard)
    mask = (farthest < settings.max_reach_squares) & (np.hypot(*offset) < around.reach) & ~marked
    value = grey[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64).ravel()[mask]
    # Heights of the parallelogram that a square is in the picture.
    heights = abs(np.linalg.det(around.axes)) / np.linalg.norm(around.axes, axis=0)[::-1]
    return _Window(mask.reshape(x.shape), offset[:, mask], value, around.gap * heights)


def _begin(window: _Window, around: Surroundings, blur: float) -> np.ndarray:
    """Return first parameters; the normals are those of the board's axes, so that the step is positive."""
    (ax, ay), (bx, by) = around.axes.T
    # The edge along y separates left from right: its normal points to the board's right; likewise the other.
    right, up = np.array([-by, bx]), np.array([ay, -ax])
    right, up = right * np.sign(right @ [ax, ay]), up * np.sign(up @ [bx, by]) * around.white
    angles = [np.arctan2(right[1], right[0]), np.arctan2(up[1], up[0])]
    black, white = np.percentile(window.value, [10, 90]) if len(window.value) else (0.0, 0.0)
    return np.array(
        [0, 0, *angles, blur, blur, (black + white) / 2, (white - black) / 2, 0, 0], dtype=np.float64
    )


def _linearise(state: np.ndarray, window: _Window) -> _Linear:
    """Return residuals and derivatives at a state."""
    blur, mean, step, slope = state[4:6, None], state[6], state[7], state[8:]
    d = window.offset - state[:2, None]
    cos, sin = np.cos(state[2:4]), np.sin(state[2:4])
    u = (cos[:, None] * d[0] + sin[:, None] * d[1]) / blur
    across = cos[:, None] * d[1] - sin[:, None] * d[0]
    correlation = np.clip(np.cos(state[2] - state[3]), -_MOST_OBLIQUE, _MOST_OBLIQUE)
    board = _blurred_board(u, float(correlation))
    light = 1 + slope @ window.offset
    dark = 2 * (ndtr(np.abs(u) - window.gap[:, None] / blur)).prod(axis=0) * (u[0] * u[1] > 0)
    plain = mean + step * (board.value - dark)
    first, second = light * step / blur * np.stack([board.by_first, board.by_second])
    turn = light * step * board.by_correlation * np.sin(state[2] - state[3])
    jacobian = np.stack(
        [
            -first * cos[0] - second * cos[1],
            -first * sin[0] - second * sin[1],
            first * across[0] - turn,
            second * across[1] + turn,
            -first * u[0],
            -second * u[1],
            light,
            light * (board.value - dark),
            window.offset[0] * plain,
            window.offset[1] * plain,
        ]
    )
    return _Linear(window.value - light * plain, jacobian, board.value - dark, np.abs(u).min(axis=0))


def _blurred_board(u: np.ndarray, correlation: float) -> _Board:
    """Return a blurred chessboard at distances from its edges, in blurs, shape (2, n)."""
    a, b = np.where(np.abs(u) < _TINY, _TINY, u)
    other = np.sqrt(1 - correlation**2)
    beside_a, beside_b = (b - correlation * a) / other, (a - correlation * b) / other
    value = 1 - 4 * owens_t(a, beside_a / a) - 4 * owens_t(b, beside_b / b) - 2 * (a * b < 0)
    exponent = (a * a - 2 * correlation * a * b + b * b) / (2 * other**2)
    return _Board(
        value=value,
        by_first=np.sqrt(2 / np.pi) * np.exp(-0.5 * a * a) * erf(beside_a / np.sqrt(2)),
        by_second=np.sqrt(2 / np.pi) * np.exp(-0.5 * b * b) * erf(beside_b / np.sqrt(2)),
        by_correlation=2 / (np.pi * other) * np.exp(-exponent),
    )


def _settle(
    state: np.ndarray, window: _Window, tolerance: float, settings: CornerSettings
) -> np.ndarray | None:
    """Iterate to the least squares (Gauss-Newton with shortened steps); None where it runs away."""
    if len(window.value) < settings.min_pixels:
        return None
    for _ in range(settings.max_iterations):
        linear = _linearise(state, window)
        normal = linear.jacobian @ linear.jacobian.T
        ridge = 1e-9 * np.diag(np.diag(normal))
        try:
            change = np.linalg.solve(normal + ridge, linear.jacobian @ linear.residual)
        except np.linalg.LinAlgError:
            return None
        if not np.isfinite(change).all():
            return None
        far, turn = np.hypot(change[0], change[1]), np.abs(change[2:4]).max()
        far = max(far / settings.max_step_px, turn / settings.max_turn_rad, 1.0)
        blurs = np.clip(state[4:6] + change[4:6] / far, state[4:6] / 2, state[4:6] * 2)
        state = state + change / far
        state[4:6] = np.maximum(blurs, settings.min_blur_px)
        if np.abs(change[:2]).max() < tolerance:
            return state
    return None


def _variance(noise: np.ndarray, board: np.ndarray, least: float) -> np.ndarray:
    """Return the noise's variance at every pixel, linear from black to white: photons, tone curves."""
    squares = noise**2
    design = np.stack([np.ones_like(board), board], axis=-1)
    fitted = design @ np.linalg.lstsq(design, squares, rcond=None)[0]
    return np.asarray(np.maximum(fitted, least * squares.mean()))


def _judge(
    state: np.ndarray, window: _Window, around: Surroundings, settings: CornerSettings
) -> CornerFit | None:
    """Return the fit with its uncertainty."""
    linear = _linearise(state, window)
    normal = linear.jacobian @ linear.jacobian.T
    # What the residual is on average at a level between black and white is a tone curve and no noise.
    level = np.round(settings.tone_levels * linear.board).astype(int) + 2 * settings.tone_levels
    mean = np.bincount(level, linear.residual) / np.maximum(np.bincount(level), 1)
    noise = linear.residual - mean[level]
    freedom = len(window.value) - _PARAMETERS - len(np.unique(level))
    if freedom < _PARAMETERS:
        return None
    try:
        gain = np.linalg.solve(normal, linear.jacobian)[:2]
    except np.linalg.LinAlgError:
        return None
    variance = _variance(noise, linear.board, settings.min_variance_share) * len(noise) / freedom
    return CornerFit(
        centre=around.centre + state[:2],
        covariance=(gain * variance) @ gain.T,
        step=2 * float(state[7]),
        roughness=float(np.sqrt((linear.residual**2).mean())) / (2 * float(state[7])),
        sums=_sums(linear, window, settings.flat_blurs),
    )


def _sums(linear: _Linear, window: _Window, flat_blurs: float) -> np.ndarray:
    """Return sums of products of pixels at all distances, the edges themselves left out of the residuals."""
    flat = linear.off_edges > flat_blurs
    planes = np.zeros((4, *window.mask.shape))  # flat or not, residual there, gradients along x and y
    planes[0][window.mask], planes[1][window.mask] = flat, np.where(flat, linear.residual, 0.0)
    planes[2:, window.mask] = linear.jacobian[:2]
    padded = np.pad(planes, ((0, 0), (0, REACH), (REACH, REACH)))
    height, width = window.mask.shape
    sums = np.empty((LAGS, SUMS))
    for lag in range(LAGS):
        down, across = divmod(lag, 2 * REACH + 1)
        products = (planes * padded[:, down : down + height, across : across + width]).sum(axis=(1, 2))
        sums[lag] = products[0], products[1], products[2] + products[3]
    return sums
