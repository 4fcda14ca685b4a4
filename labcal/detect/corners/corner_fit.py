"""Sub-pixel fit of one corner of a chessboard, by Gauss-Newton."""

from dataclasses import dataclass, field, replace

import numpy as np

from labcal.detect.corners.corner_kernel import LIGHT_KNOWN, PARAMETERS, FitLimits, settled
from labcal.detect.corners.corner_model import CornerPixels, LinearisedCorner, linearise
from labcal.detect.corners.edge_waves import edge_powers
from labcal.detect.edges.residuals import LAGS, REACH, SUMS
from labcal.detect.grey import GreyPicture
from labcal.detect.stage_settings.corner import CornerSettings


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
    clear : float
        Distance from both edges beyond which there may be marks in squares of either colour, in squares.
    share : float
        How far from the corner the pixels reach, in squares.
    bend : ndarray, shape (2,)
        Curvature of either edge towards its normal, 1/px.
    """

    centre: np.ndarray
    axes: np.ndarray
    white: int
    gap: float
    reach: float
    clear: float = 1.0
    share: float = 0.45
    bend: np.ndarray = field(default_factory=lambda: np.zeros(2))


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
    powers : ndarray, shape (WAVES, 2)
        Power of the residuals along the edges by wave, and that of the noise which the covariance counts
        with, see :func:`labcal.detect.corners.edge_waves.edge_powers`.
    reach : float
        The greatest distance of a pixel of the fit from the corner, px.
    state : ndarray, shape (PARAMETERS,)
        The parameters of the fit; the corner's place is relative to where it began.
    """

    centre: np.ndarray
    covariance: np.ndarray
    step: float
    roughness: float
    sums: np.ndarray
    powers: np.ndarray
    reach: float
    state: np.ndarray


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
    window = _window(grey, around, settings.marker_guard_blurs * settings.first_blur_px / narrow)
    first = settle(
        _begin(window, around, settings.first_blur_px), window, settings.first_tolerance_px, settings
    )
    if first is None:
        return None
    # What is left out around markers follows the blur, now that it is known.
    blur = float(first[4:6].max())
    window = _window(grey, around, settings.marker_guard_blurs * blur / narrow)
    state = settle(first, window, settings.tolerance_px, settings)
    if state is None or state[7] <= 0 or state[4:6].max() > settings.max_blur_squares * narrow:
        return None
    moved = float(np.hypot(state[0], state[1]))
    if moved > min(settings.max_move_squares * square, around.reach):
        return None
    if is_cut(around.centre + state[:2], grey, settings.frame_margin_px):
        return None
    return judge(state, window, around.centre, settings)


@dataclass(frozen=True)
class WideFit:
    """A fit to the pixels along all of a corner's edges, without its uncertainty.

    Attributes
    ----------
    state : ndarray, shape (PARAMETERS,)
    window : CornerPixels
    start : ndarray, shape (2,)
        Where the fit began, px, to which the state's place is relative.
    """

    state: np.ndarray
    window: CornerPixels
    start: np.ndarray

    @property
    def centre(self) -> np.ndarray:
        """The crossing of the edges, px."""
        return np.asarray(self.start + self.state[:2])

    @property
    def roughness(self) -> float:
        """Root mean square residual over the step from black to white."""
        residual = linearise(self.state, self.window).residual
        return float(np.sqrt((residual**2).mean())) / (2.0 * float(self.state[7]))


def widen(
    grey: GreyPicture, around: Surroundings, first: np.ndarray, settings: CornerSettings
) -> WideFit | None:
    """Fit the same to other pixels, those along the edges, from the state of a first fit on.

    Parameters
    ----------
    grey : ndarray, shape (h, w)
        The picture.
    around : Surroundings
        With the corner of the first fit as its centre.
    first : ndarray, shape (PARAMETERS,)
        The first fit's state.
    settings : CornerSettings

    Returns
    -------
    WideFit or None
        None where the fit leaves the first one by more than either may be off.
    """
    begin = np.concatenate([np.zeros(2), first[2:]])
    blur = float(begin[4:6].max())
    narrow = float(np.linalg.svd(around.axes, compute_uv=False)[-1])
    window = _window(grey, around, settings.marker_guard_blurs * blur / narrow)
    window = window.along_edges(begin, settings.edge_blurs)
    state = settle(begin, window, settings.first_tolerance_px, settings)
    if state is None or state[7] <= 0 or state[4:6].max() > settings.max_blur_squares * narrow:
        return None
    if float(np.hypot(state[0], state[1])) > settings.max_refit_blurs * blur:
        return None
    return WideFit(state, window, around.centre)


def with_known_light(
    wide: WideFit, slope: np.ndarray, bend: np.ndarray, settings: CornerSettings
) -> CornerFit | None:
    """Return a wide fit with the slope of the light and the bend of its edges as they are known.

    Parameters
    ----------
    wide : WideFit
    slope : ndarray, shape (2,)
        At the corner.
    bend : ndarray, shape (2,)
    settings : CornerSettings

    Returns
    -------
    CornerFit or None
        None where it does not converge.
    """
    begin = wide.state.copy()
    # The model's light is 1 where the fit began: the slope at the corner is over the level there.
    begin[8:] = slope / (1.0 - slope @ begin[:2])
    window = replace(wide.window, bend=bend)
    state = settle(begin, window, settings.tolerance_px, settings, LIGHT_KNOWN)
    if state is None or state[7] <= 0:
        return None
    return judge(state, window, wide.start, settings, LIGHT_KNOWN)


def is_cut(place: np.ndarray, grey: GreyPicture, margin: float) -> bool:
    """Tell whether the frame is nearer to a corner than a margin (px), or leaves nothing of it."""
    last = np.array(grey.shape[::-1]) - 1
    return bool((place < margin).any() or (place > last - margin).any())


def _window(grey: GreyPicture, around: Surroundings, guard: float) -> CornerPixels:
    """Select the pixels around a corner that belong to its own edges; `guard` is in squares."""
    height, width = grey.shape
    low = np.maximum(np.ceil(around.centre - around.reach), 0).astype(int)
    high = np.minimum(np.floor(around.centre + around.reach), [width - 1, height - 1]).astype(int)
    if (high < low).any():
        return CornerPixels(np.zeros((0, 0), dtype=bool), np.zeros((2, 0)), np.zeros(0), np.zeros(2))
    y, x = np.mgrid[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64)
    offset = np.stack([x.ravel() - around.centre[0], y.ravel() - around.centre[1]])
    along, up = np.linalg.solve(around.axes, offset)
    nearest, farthest = np.minimum(np.abs(along), np.abs(up)), np.maximum(np.abs(along), np.abs(up))
    marked = (along * up * around.white > 0) & (nearest > around.gap - guard)
    marked |= nearest > around.clear - guard
    mask = (farthest < around.share) & (np.hypot(*offset) < around.reach) & ~marked
    value = grey[low[1] : high[1] + 1, low[0] : high[0] + 1].astype(np.float64).ravel()[mask]
    # Heights of the parallelogram that a square is in the picture.
    heights = abs(np.linalg.det(around.axes)) / np.linalg.norm(around.axes, axis=0)[::-1]
    return CornerPixels(mask.reshape(x.shape), offset[:, mask], value, around.gap * heights, bend=around.bend)


def _begin(window: CornerPixels, around: Surroundings, blur: float) -> np.ndarray:
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


def settle(
    state: np.ndarray,
    window: CornerPixels,
    tolerance: float,
    settings: CornerSettings,
    free: int = PARAMETERS,
) -> np.ndarray | None:
    """Iterate to the least squares (Gauss-Newton with shortened steps); None where it runs away."""
    if len(window.value) < settings.min_pixels:
        return None
    found = state.astype(np.float64)
    return found if settled(found, window.arrays, (tolerance, free), settings.limits(FitLimits)) else None


def _variance(noise: np.ndarray, board: np.ndarray, least: float) -> np.ndarray:
    """Return the noise's variance at every pixel, linear from black to white: photons, tone curves."""
    squares = noise**2
    design = np.stack([np.ones_like(board), board], axis=-1)
    fitted = design @ np.linalg.lstsq(design, squares, rcond=None)[0]
    return np.asarray(np.maximum(fitted, least * squares.mean()))


def judge(
    state: np.ndarray,
    window: CornerPixels,
    centre: np.ndarray,
    settings: CornerSettings,
    free: int = PARAMETERS,
) -> CornerFit | None:
    """Return the fit with its uncertainty; the parameters from number `free` on are taken for known."""
    linear = linearise(state, window)
    linear = replace(linear, jacobian=linear.jacobian[:free])
    normal = linear.jacobian @ linear.jacobian.T
    # What the residual is on average at a level between black and white is a tone curve and no noise.
    level = np.round(settings.tone_levels * linear.board).astype(int) + 2 * settings.tone_levels
    mean = np.bincount(level, linear.residual) / np.maximum(np.bincount(level), 1)
    noise = linear.residual - mean[level]
    freedom = len(window.value) - PARAMETERS - len(np.unique(level))
    if freedom < PARAMETERS:
        return None
    try:
        gain = np.linalg.solve(normal, linear.jacobian)[:2]
    except np.linalg.LinAlgError:
        return None
    variance = _variance(noise, linear.board, settings.min_variance_share) * len(noise) / freedom
    offset = window.offset - state[:2, None]
    return CornerFit(
        centre=centre + state[:2],
        covariance=(gain * variance) @ gain.T,
        step=2 * float(state[7]),
        roughness=float(np.sqrt((linear.residual**2).mean())) / (2 * float(state[7])),
        sums=_sums(linear, window, settings.flat_blurs),
        powers=edge_powers(linear, offset, gain, variance),
        reach=float(np.hypot(offset[0], offset[1]).max()),
        state=state,
    )


def _sums(linear: LinearisedCorner, window: CornerPixels, flat_blurs: float) -> np.ndarray:
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
